#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "admin/json_field.hpp"
#include "admin/json_forms.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kMostFloors = 256;
constexpr std::size_t kMostWalls = 20000;

Floor floor_of(const JsonField& json) {
  Floor floor;
  floor.ordinal = json.member("ordinal").floor();
  floor.label = json.text("label", std::to_string(floor.ordinal.value), 64);
  if (const auto outline = json.maybe("outline")) floor.outline = outline->polygon();
  if (const auto walkable = json.maybe("walkable")) floor.walkable = walkable->polygons();
  if (const auto walls = json.maybe("walls")) {
    for (const JsonField& wall : walls->list(kMostWalls)) floor.walls.push_back(wall.line());
  }
  return floor;
}

// Ascending, as the store keeps them.
std::vector<Floor> floors_of(const JsonField& json) {
  std::vector<Floor> floors;
  std::set<FloorOrdinal> seen;
  for (const JsonField& entry : json.list(kMostFloors)) {
    floors.push_back(floor_of(entry));
    if (!seen.insert(floors.back().ordinal).second) {
      entry.member("ordinal").refuse(FaultCode::kConflict, std::to_string(floors.back().ordinal.value) + " stands twice");
    }
  }
  return floors;
}

Georeference georeference_of(const JsonField& json) {
  return {json.member("origin").geo_point(), kDegree * json.number("y_axis_azimuth_deg", 0, -360, 360)};
}

MagneticField field_of(const JsonField& json) {
  return {kDegree * json.number("declination_deg", 0, -180, 180), kDegree * json.number("dip_deg", 0, -90, 90),
          json.number("norm_ut", 0, 0, 100)};
}

PublicationPolicy policy_of(const JsonField& json) {
  const std::string name = json.text(64);
  if (name != "automatic" && name != "reviewed") json.refuse(FaultCode::kUnknownName, "must be automatic or reviewed");
  return name == "automatic" ? PublicationPolicy::kAutomatic : PublicationPolicy::kReviewed;
}

Json to_json(const std::vector<BuildingPoint>& line) {
  Json points = Json::array();
  for (const BuildingPoint& point : line) points.push_back({point.x_m, point.y_m});
  return points;
}

Json to_json(const Polygon& polygon) {
  Json rings = Json::array();
  for (const Ring& ring : polygon.rings) rings.push_back(to_json(ring));
  return rings;
}

Json to_json(const Floor& floor) {
  Json walkable = Json::array();
  for (const Polygon& polygon : floor.walkable) walkable.push_back(to_json(polygon));
  Json walls = Json::array();
  for (const Polyline& wall : floor.walls) walls.push_back(to_json(wall));
  return {{"ordinal", floor.ordinal.value},
          {"label", floor.label},
          {"outline", to_json(floor.outline)},
          {"walkable", std::move(walkable)},
          {"walls", std::move(walls)}};
}

Json summary_of(const BuildingRecord& building) {
  return {{"id", building.id.value}, {"name", building.name}, {"pipeline", building.pipeline}, {"survey_version", building.survey_version}};
}

}  // namespace

Result<BuildingRecord> parse_building(std::string_view json) {
  return JsonField::reading([&] {
    const JsonField whole = JsonField::object_in(json);
    BuildingRecord building;
    building.name = whole.member("name").text(256);
    if (building.name.empty()) whole.member("name").refuse(FaultCode::kOutOfRange, "must not be empty");
    if (const auto reference = whole.maybe("georeference")) building.georeference = georeference_of(*reference);
    if (const auto field = whole.maybe("magnetic_field")) building.magnetic_field = field_of(*field);
    if (const auto floors = whole.maybe("floors")) building.floors = floors_of(*floors);
    building.pipeline = whole.text("pipeline", building.pipeline, 64);
    if (const auto policy = whole.maybe("publication")) building.publication = policy_of(*policy);
    return building;
  });
}

Result<std::vector<Floor>> parse_floors(std::string_view json) {
  return JsonField::reading([&] { return floors_of(JsonField::object_in(json).member("floors")); });
}

std::string to_json(const BuildingRecord& building, std::uint64_t points, std::uint64_t radio_map_version) {
  Json json = summary_of(building);
  json["publication"] = building.publication == PublicationPolicy::kAutomatic ? "automatic" : "reviewed";
  json["radio_map_version"] = radio_map_version;
  json["points"] = points;
  if (building.georeference) {
    const GeoPoint& origin = building.georeference->origin;
    json["georeference"] = {{"origin", {{"latitude_deg", origin.latitude_deg}, {"longitude_deg", origin.longitude_deg}}},
                            {"y_axis_azimuth_deg", building.georeference->y_axis_azimuth_rad / kDegree}};
  }
  json["magnetic_field"] = {{"declination_deg", building.magnetic_field.declination_rad / kDegree},
                            {"dip_deg", building.magnetic_field.dip_rad / kDegree},
                            {"norm_ut", building.magnetic_field.norm_ut}};
  json["floors"] = Json::array();
  for (const Floor& floor : building.floors) json["floors"].push_back(to_json(floor));
  return json.dump();
}

std::string to_json(const std::vector<BuildingRecord>& buildings, std::uint64_t next) {
  Json entries = Json::array();
  for (const BuildingRecord& building : buildings) entries.push_back(summary_of(building));
  Json json{{"buildings", std::move(entries)}};
  if (next != 0) json["next"] = next;
  return json.dump();
}

}  // namespace wayfuse
