#include <nlohmann/json.hpp>
#include <numbers>

#include "sdk/src/simulator/world.hpp"

namespace wayfuse::simulator {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kDegree = std::numbers::pi / 180.0;

Json to_json(const Polygon& polygon) {
  Json rings = Json::array();
  for (const Ring& ring : polygon.rings) {
    Json points = Json::array();
    for (const BuildingPoint& point : ring) points.push_back({point.x_m, point.y_m});
    rings.push_back(std::move(points));
  }
  return rings;
}

}  // namespace

std::string to_building_json(const World& world) {
  Json floors = Json::array();
  for (const WorldFloor& floor : world.floors) {
    Json walkable = Json::array();
    for (const Polygon& polygon : floor.plan.walkable) walkable.push_back(to_json(polygon));
    floors.push_back({{"ordinal", floor.plan.ordinal.value},
                      {"label", floor.plan.label},
                      {"outline", to_json(floor.plan.outline)},
                      {"walkable", std::move(walkable)}});
  }
  const Json building{{"name", world.name},
                      {"pipeline", world.pipeline},
                      {"georeference",
                       {{"origin",
                         {{"latitude_deg", world.georeference.origin.latitude_deg},
                          {"longitude_deg", world.georeference.origin.longitude_deg}}},
                        {"y_axis_azimuth_deg", world.georeference.y_axis_azimuth_rad / kDegree}}},
                      {"magnetic_field",
                       {{"declination_deg", world.magnetic_field.declination_rad / kDegree},
                        {"dip_deg", world.magnetic_field.dip_rad / kDegree},
                        {"norm_ut", world.magnetic_field.norm_ut}}},
                      {"floors", std::move(floors)}};
  return building.dump(2);
}

}  // namespace wayfuse::simulator
