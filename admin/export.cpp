#include "admin/export.hpp"

#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "admin/json_forms.hpp"
#include "admin/plan/features.hpp"
#include "admin/plan/planar.hpp"
#include "admin/plan_forms.hpp"
#include "admin/webhook_forms.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kReadme =
    "A building, as it was put into wayfuse.\n\n"
    "building.json    description and floors, metres in the building's own frame; POST it to /v1/buildings\n"
    "plan.geojson     outlines, walkable areas and walls (RFC 7946; plain metres where the building has no georeference);\n"
    "                 PUT it to /v1/buildings/{building}/plan, with ?coordinates=local where it is plain metres\n"
    "zones.json       zones with their tolerances\n"
    "points.csv       reference points, one row a reading\n"
    "webhooks.json    where events go; secrets are left out\n"
    "floor-N.png/jpg  floor images, and floor-N.json: where they lie\n"
    "quality-walk-N   recorded walks the radio maps are measured by\n";

/// Points of a floor plan as GeoJSON has them.
class Positions {
 public:
  explicit Positions(const std::optional<Georeference>& georeference) : georeference_(georeference) {}
  Json operator()(BuildingPoint point) const {
    if (!georeference_) return {point.x_m, point.y_m};
    const GeoPoint geo = georeference_->to_geo(point);
    return {geo.longitude_deg, geo.latitude_deg};
  }
  Json line(const std::vector<BuildingPoint>& points, bool closed) const {
    Json list = Json::array();
    for (const BuildingPoint& point : points) list.push_back((*this)(point));
    if (closed && !points.empty()) list.push_back((*this)(points.front()));
    return list;
  }
  // Even-odd rings as GeoJSON wants them: an outer ring with its holes behind it.
  Json multi_polygon(const Polygon& polygon) const {
    Json parts = Json::array();
    for (const auto& [ring, hole] : planar::outlines_of(polygon)) {
      if (!hole || parts.empty()) parts.push_back(Json::array());
      parts.back().push_back(line(ring, true));
    }
    return {{"type", "MultiPolygon"}, {"coordinates", std::move(parts)}};
  }

 private:
  const std::optional<Georeference>& georeference_;
};

Json feature(const char* kind, const Floor& floor, Json geometry) {
  return {{"type", "Feature"},
          {"properties", {{"wayfuse", kind}, {"floor", floor.ordinal.value}, {"label", floor.label}}},
          {"geometry", std::move(geometry)}};
}

std::string plan_of(const BuildingRecord& building) {
  const Positions positions(building.georeference);
  Json features = Json::array();
  for (const Floor& floor : building.floors) {
    if (!floor.outline.rings.empty()) features.push_back(feature("outline", floor, positions.multi_polygon(floor.outline)));
    for (const Polygon& walkable : floor.walkable) features.push_back(feature("walkable", floor, positions.multi_polygon(walkable)));
    if (floor.walls.empty()) continue;
    Json lines = Json::array();
    for (const Polyline& wall : floor.walls) lines.push_back(positions.line(wall, false));
    features.push_back(feature("wall", floor, {{"type", "MultiLineString"}, {"coordinates", std::move(lines)}}));
  }
  return Json{{"type", "FeatureCollection"}, {"features", std::move(features)}}.dump();
}

Result<std::string> points_csv(BuildingDatabase& database) {
  std::string csv = points_csv_header();
  for (PointQuery query;;) {
    const auto page = database.points(query);
    if (!page) return page.fault();
    if (page->empty()) return csv;
    query.after_id = page->back().id;
    for (const StoredPoint& point : *page) csv += to_csv(point);
  }
}

Result<void> add_images(BuildingDatabase& database, std::map<std::string, std::string>& files) {
  const auto floors = database.floor_images();
  if (!floors) return floors.fault();
  for (const FloorOrdinal floor : *floors) {
    auto image = database.floor_image(floor);
    if (!image) return image.fault();
    const std::string name = "floor-" + std::to_string(floor.value);
    files[name + ".json"] = to_json(*image);
    files[name + (image->media_type == "image/png" ? ".png" : ".jpg")] = std::move(image->content);
  }
  return {};
}

Result<void> add_quality_walks(BuildingDatabase& database, std::map<std::string, std::string>& files) {
  const auto walks = database.quality_walks();
  if (!walks) return walks.fault();
  for (const QualityWalkRecord& walk : *walks) {
    auto content = database.quality_walk_content(walk.id);
    if (!content) return content.fault();
    files["quality-walk-" + std::to_string(walk.id)] = *std::move(content);
  }
  return {};
}

}  // namespace

Result<std::string> export_archive(BuildingDatabase& database) {
  const auto building = database.building();
  if (!building) return building.fault();
  const auto count = database.count_points();
  if (!count) return count.fault();
  const auto zones = database.zones();
  if (!zones) return zones.fault();
  const auto webhooks = database.webhooks();
  if (!webhooks) return webhooks.fault();
  auto points = points_csv(database);
  if (!points) return points.fault();
  std::map<std::string, std::string> files = {{"README.txt", kReadme},
                                              {"building.json", to_json(*building, *count, 0)},
                                              {"plan.geojson", plan_of(*building)},
                                              {"zones.json", to_json(*zones, 0)},
                                              {"points.csv", *std::move(points)}};
  std::vector<std::pair<WebhookRecord, WebhookState>> targets;
  for (const WebhookRecord& webhook : *webhooks) targets.emplace_back(webhook, WebhookState());
  files["webhooks.json"] = to_json(targets, 0);
  if (const auto added = add_images(database, files); !added) return added.fault();
  if (const auto added = add_quality_walks(database, files); !added) return added.fault();
  return zip(files);
}

}  // namespace wayfuse
