#include "tests/evaluation/datasets/floor_map.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

namespace wayfuse {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kEarth_m = 6378137.0;  // EPSG:3857's sphere
constexpr double kDegree = std::numbers::pi / 180.0;

using MercatorRing = std::vector<MercatorPoint>;

Result<json> read_json(const fs::path& file) {
  std::ifstream in(file);
  json content = json::parse(in, nullptr, false);
  if (content.is_discarded()) return Fault{FaultCode::kMalformed, file.string(), "is not JSON"};
  return content;
}

Fault broken(const fs::path& file, std::size_t feature, const std::string& cause) {
  return {FaultCode::kMalformed, file.string(), "features[" + std::to_string(feature) + "]: " + cause};
}

// All rings of a Polygon or MultiPolygon, without the repeated last point; false if the geometry is neither.
bool rings_of(const json& geometry, std::vector<MercatorRing>& rings) {
  if (!geometry.is_object()) return false;
  const std::string type = geometry.value("type", "");
  const auto coordinates = geometry.find("coordinates");
  if (coordinates == geometry.end() || !coordinates->is_array()) return false;
  if (type != "Polygon" && type != "MultiPolygon") return false;
  const json parts = type == "Polygon" ? json::array({*coordinates}) : *coordinates;
  for (const json& part : parts) {
    if (!part.is_array()) return false;
    for (const json& ring : part) {
      MercatorRing points;
      if (!ring.is_array()) return false;
      for (const json& point : ring) {
        if (!point.is_array() || point.size() < 2 || !point[0].is_number() || !point[1].is_number()) return false;
        points.push_back(to_mercator({point[1].get<double>(), point[0].get<double>()}));
      }
      if (points.size() > 1 && points.front().x == points.back().x && points.front().y == points.back().y) points.pop_back();
      if (points.size() >= 3) rings.push_back(std::move(points));
    }
  }
  return true;
}

struct Box {
  MercatorPoint low{1e300, 1e300};
  MercatorPoint high{-1e300, -1e300};
};

Box box_of(const std::vector<MercatorRing>& rings) {
  Box box;
  for (const MercatorRing& ring : rings) {
    for (const MercatorPoint p : ring) {
      box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
      box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
    }
  }
  return box;
}

// Rings drawn twice or inside one another would turn the even-odd rule around: keep the outermost.
std::vector<Ring> outermost(std::vector<Ring> rings) {
  std::vector<Ring> kept;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const bool inside_another = std::any_of(rings.begin(), rings.end(), [&](const Ring& other) {
      if (&other == &rings[i] || other.empty()) return false;
      if (other == rings[i]) return &other < &rings[i];
      const Polygon around{{other}};
      return std::all_of(rings[i].begin(), rings[i].end(), [&](BuildingPoint p) { return contains(around, p); });
    });
    if (!inside_another) kept.push_back(rings[i]);
  }
  return kept;
}

Result<double> metres_per_unit(const fs::path& file, const Box& box, std::vector<std::string>& complaints) {
  const double middle_deg = to_geo({box.low.x, 0.5 * (box.low.y + box.high.y)}).latitude_deg;
  const double by_latitude = std::cos(middle_deg * kDegree);
  if (!fs::exists(file)) {
    complaints.push_back(file.string() + ": missing; the scale comes from the latitude");
    return by_latitude;
  }
  const auto info = read_json(file);
  if (!info) return info.fault();
  const auto map_info = info->is_object() ? info->value("map_info", json()) : json();
  const auto width = map_info.is_object() ? map_info.value("width", json()) : json();
  if (!width.is_number() || width.get<double>() <= 0.0) {
    return Fault{FaultCode::kMalformed, file.string(), "map_info.width: a length in metres expected"};
  }
  const double scale = width.get<double>() / (box.high.x - box.low.x);
  if (std::abs(scale / by_latitude - 1.0) > 0.05) {
    complaints.push_back(file.string() + ": map_info.width does not fit the outline's latitude");
  }
  return scale;
}

}  // namespace

MercatorPoint to_mercator(GeoPoint point) {
  return {kEarth_m * point.longitude_deg * kDegree,
          kEarth_m * std::log(std::tan(std::numbers::pi / 4 + point.latitude_deg * kDegree / 2))};
}

GeoPoint to_geo(MercatorPoint point) {
  return {(2 * std::atan(std::exp(point.y / kEarth_m)) - std::numbers::pi / 2) / kDegree, point.x / kEarth_m / kDegree};
}

GeoPoint FloorMap::corner_geo() const {
  return to_geo(corner.value());
}

BuildingPoint FloorMap::corner_seen_from(const FloorMap& other) const {
  return {(corner->x - other.corner->x) * other.metres_per_unit, (corner->y - other.corner->y) * other.metres_per_unit};
}

Result<FloorMap> read_floor_map(const std::string& folder, std::vector<std::string>& complaints) {
  FloorMap map;
  const fs::path file = fs::path(folder) / "geojson_map.json";
  if (!fs::exists(file)) {
    complaints.push_back(file.string() + ": missing; this floor has no outline");
    return map;
  }
  const auto content = read_json(file);
  if (!content) return content.fault();
  const json features = content->is_object() ? content->value("features", json()) : json();
  if (!features.is_array() || features.empty())
    return Fault{FaultCode::kMalformed, file.string(), "features: at least one expected"};

  std::vector<MercatorRing> outline;
  if (!rings_of(features[0].value("geometry", json()), outline) || outline.empty()) {
    return broken(file, 0, "the floor's outline as Polygon or MultiPolygon expected");
  }
  const Box box = box_of(outline);
  const auto scale = metres_per_unit(fs::path(folder) / "floor_info.json", box, complaints);
  if (!scale) return scale.fault();
  map.corner = box.low;
  map.metres_per_unit = *scale;
  const auto to_floor = [&](const MercatorRing& ring) {
    Ring points;
    for (const MercatorPoint p : ring) points.push_back({(p.x - box.low.x) * *scale, (p.y - box.low.y) * *scale});
    return points;
  };
  for (const MercatorRing& ring : outline) map.outline.rings.push_back(to_floor(ring));
  std::vector<Ring> shops;
  for (std::size_t i = 1; i < features.size(); ++i) {
    std::vector<MercatorRing> rings;
    // Points and lines among the features are signs and doors, not rooms.
    if (!features[i].is_object() || !rings_of(features[i].value("geometry", json()), rings)) continue;
    for (const MercatorRing& ring : rings) shops.push_back(to_floor(ring));
  }
  map.walkable = map.outline;
  for (Ring& shop : outermost(std::move(shops))) map.walkable.rings.push_back(std::move(shop));
  return map;
}

void move_by(Floor& floor, BuildingPoint offset) {
  const auto move = [&](Polygon& polygon) {
    for (Ring& ring : polygon.rings) {
      for (BuildingPoint& p : ring) p = {p.x_m + offset.x_m, p.y_m + offset.y_m};
    }
  };
  move(floor.outline);
  for (Polygon& polygon : floor.walkable) move(polygon);
}

}  // namespace wayfuse
