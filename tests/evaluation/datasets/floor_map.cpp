#include "tests/evaluation/datasets/floor_map.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "sdk/src/recording/import/text_line.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kEarth_m = 6378137.0;  // EPSG:3857's sphere
constexpr double kDegree = std::numbers::pi / 180.0;

using MercatorRing = std::vector<MercatorPoint>;

constexpr double kMercatorEnd_deg = 85.06;
constexpr int kDeepest = 8;            // geometries within geometries
constexpr double kSurrounded = 0.75;   // of the other shapes, by an outline that is not the first feature
constexpr double kOdd = 0.05, kContradiction = 0.2;  // between scales
constexpr double kInside = 0.95, kMargin_m = 5.0;    // way points
constexpr double kLost = 0.1;          // of the outline's longer side

constexpr const char* kNoOutline =
    "; this floor has no outline, and its frame is unknown: it is laid on another floor's corner, so that errors of positions on "
    "the wrong floor say nothing";

std::optional<json> read_json(const fs::path& file) {
  std::ifstream in(file);
  json content = json::parse(in, nullptr, false);
  if (content.is_discarded()) return std::nullopt;
  return content;
}

const json& member(const json& object, const char* name) {
  static const json kNothing;
  if (!object.is_object()) return kNothing;
  const auto found = object.find(name);
  return found == object.end() ? kNothing : *found;
}

/// What a feature draws.
struct Shape {
  std::vector<MercatorRing> rings;  // of its polygons, without the repeated last point
  std::vector<MercatorRing> lines;  // closed ones: an outline may be drawn so
  std::string wrong;                // why it cannot be used; points and open lines are signs and doors, and fine
};

void add_ring(const json& ring, std::vector<MercatorRing>& rings, Shape& shape) {
  MercatorRing points;
  if (!ring.is_array()) return void(shape.wrong = "a ring is no list");
  for (const json& point : ring) {
    if (!point.is_array() || point.size() < 2 || !point[0].is_number() || !point[1].is_number())
      return void(shape.wrong = "a point is no pair of numbers");
    const GeoPoint geo{point[1].get<double>(), point[0].get<double>()};
    if (std::abs(geo.latitude_deg) > kMercatorEnd_deg || std::abs(geo.longitude_deg) > 180.0)
      return void(shape.wrong = "a point is no longitude and latitude in degrees");
    points.push_back(to_mercator(geo));
  }
  const bool closed = points.size() > 1 && points.front().x == points.back().x && points.front().y == points.back().y;
  if (&rings == &shape.lines && !closed) return;
  if (closed) points.pop_back();
  if (points.size() >= 3) rings.push_back(std::move(points));
}

void add_polygon(const json& polygon, Shape& shape) {
  if (!polygon.is_array()) return void(shape.wrong = "a polygon is no list");
  for (const json& ring : polygon) add_ring(ring, shape.rings, shape);
}

void add_geometry(const json& geometry, int depth, Shape& shape) {
  const json& type = member(geometry, "type");
  if (!type.is_string()) return void(shape.wrong = "has no geometry");
  const json& coordinates = member(geometry, "coordinates");
  if (type == "Polygon") add_polygon(coordinates, shape);
  if (type == "LineString") add_ring(coordinates, shape.lines, shape);
  if (type == "MultiPolygon") {
    if (!coordinates.is_array()) return void(shape.wrong = "coordinates are no list");
    for (const json& polygon : coordinates) add_polygon(polygon, shape);
  }
  if (type == "GeometryCollection" && depth < kDeepest) {
    for (const json& part : member(geometry, "geometries")) add_geometry(part, depth + 1, shape);
  }
}

// Of a feature collection, a feature alone or a geometry alone.
std::vector<Shape> shapes_of(const json& content) {
  std::vector<Shape> shapes;
  const json& features = member(content, "features");
  const auto add = [&](const json& geometry) {
    Shape& shape = shapes.emplace_back();
    add_geometry(geometry, 0, shape);
    if (!shape.wrong.empty()) shape.rings.clear(), shape.lines.clear();
  };
  if (features.is_array()) {
    for (const json& feature : features) add(member(feature, "geometry"));
  } else if (member(content, "geometry").is_object()) {
    add(member(content, "geometry"));
  } else {
    add(content);
  }
  return shapes;
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

double area(const Box& box) { return box.high.x < box.low.x ? 0.0 : (box.high.x - box.low.x) * (box.high.y - box.low.y); }

bool within(const Box& box, MercatorPoint p) {
  return p.x >= box.low.x && p.x <= box.high.x && p.y >= box.low.y && p.y <= box.high.y;
}

// Absent = nothing here is a floor's outline.
std::optional<std::size_t> outline_among(const std::vector<Shape>& shapes) {
  std::vector<Box> boxes;
  for (const Shape& shape : shapes) boxes.push_back(box_of(shape.rings.empty() ? shape.lines : shape.rings));
  const auto largest = static_cast<std::size_t>(std::ranges::max_element(boxes, {}, area) - boxes.begin());
  if (boxes.empty() || area(boxes[largest]) <= 0.0) return std::nullopt;
  if (largest == 0) return 0;
  std::size_t others = 0, surrounded = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (i == largest || area(boxes[i]) <= 0.0) continue;
    ++others;
    surrounded += within(boxes[largest], {0.5 * (boxes[i].low.x + boxes[i].high.x), 0.5 * (boxes[i].low.y + boxes[i].high.y)});
  }
  if (static_cast<double>(surrounded) >= kSurrounded * static_cast<double>(others)) return largest;
  if (area(boxes[0]) > 0.0 && !shapes[0].rings.empty()) return 0;
  return std::nullopt;
}

// A length as a number or as text; 0 = none.
double length_in(const json& info, const char* name) {
  const json& value = member(info, name);
  double length = 0.0;
  if (value.is_number()) length = value.get<double>();
  if (value.is_string()) length = number(value.get_ref<const std::string&>()).value_or(0.0);
  return std::isfinite(length) && length > 0.0 ? length : 0.0;
}

bool inside(const std::vector<BuildingPoint>& points, double width_m, double height_m) {
  const auto in = std::ranges::count_if(points, [&](BuildingPoint p) {
    return p.x_m >= -kMargin_m && p.x_m <= width_m + kMargin_m && p.y_m >= -kMargin_m && p.y_m <= height_m + kMargin_m;
  });
  return static_cast<double>(in) >= kInside * static_cast<double>(points.size());
}

double longer_side_m(const std::vector<BuildingPoint>& points) {
  const auto [west, east] = std::ranges::minmax(points, {}, &BuildingPoint::x_m);
  const auto [south, north] = std::ranges::minmax(points, {}, &BuildingPoint::y_m);
  return std::max(east.x_m - west.x_m, north.y_m - south.y_m);
}

// Absent = way points lie outside of this outline, whichever way it is scaled.
std::optional<double> metres_per_unit(const fs::path& file, const Box& box, std::vector<std::string>& complaints,
                       const std::function<std::vector<BuildingPoint>()>& way_points) {
  const double middle_deg = to_geo({box.low.x, 0.5 * (box.low.y + box.high.y)}).latitude_deg;
  const double by_latitude = std::cos(middle_deg * kDegree);
  const auto complain = [&](const std::string& what) { complaints.push_back(file.string() + ": " + what); };
  const auto from_latitude = [&](const std::string& what) -> std::optional<double> {
    complain(what + "; the scale comes from the latitude");
    return by_latitude;
  };
  if (!fs::exists(file)) return from_latitude("missing");
  const auto info = read_json(file);
  if (!info) return from_latitude("is not JSON");
  const json& map_info = member(*info, "map_info").is_object() ? member(*info, "map_info") : *info;
  const double width_m = length_in(map_info, "width"), height_m = length_in(map_info, "height");
  if (width_m == 0.0) return from_latitude("map_info.width: a length in metres expected");
  const double width = box.high.x - box.low.x, height = box.high.y - box.low.y, scale = width_m / width;
  const double off = std::abs(scale / by_latitude - 1.0);
  if (off > kContradiction) {
    const std::vector<BuildingPoint> points = way_points();
    const bool proportioned = height_m > 0.0 && std::abs(height_m / (height * scale) - 1.0) <= kOdd;
    const bool found = proportioned && !points.empty() && inside(points, width_m, height_m) &&
                       longer_side_m(points) >= kLost * std::max(width_m, height_m);
    if (!found && !inside(points, width * by_latitude, height * by_latitude)) return std::nullopt;
    if (!found) return from_latitude("map_info.width contradicts the outline's latitude");
    complain("map_info.width contradicts the outline's latitude; it is taken, as the way points lie inside");
  } else if (off > kOdd) {
    complain("map_info.width does not fit the outline's latitude");
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

FloorMap read_floor_map(const std::string& folder, std::vector<std::string>& complaints,
                        const std::function<std::vector<BuildingPoint>()>& way_points) {
  const fs::path file = fs::path(folder) / "geojson_map.json";
  const auto complain = [&](const std::string& what) { complaints.push_back(file.string() + ": " + what); };
  const auto without_outline = [&](const std::string& what) {
    complain(what + kNoOutline);
    return FloorMap{};
  };
  if (!fs::exists(file)) return without_outline("missing");
  const auto content = read_json(file);
  if (!content) return without_outline("is not JSON");
  const std::vector<Shape> shapes = shapes_of(*content);
  const auto chosen = outline_among(shapes);
  if (!chosen) {
    return without_outline(shapes.empty() || shapes[0].wrong.empty() ? "no polygon surrounds the others"
                                                                     : "features[0]: " + shapes[0].wrong);
  }
  if (*chosen > 0) complain("the outline is features[" + std::to_string(*chosen) + "], the largest one, and not the first");
  const Shape& drawn = shapes[*chosen];
  const std::vector<MercatorRing>& outline = drawn.rings.empty() ? drawn.lines : drawn.rings;
  const Box box = box_of(outline);
  FloorMap map;
  const auto scale = metres_per_unit(fs::path(folder) / "floor_info.json", box, complaints, way_points);
  if (!scale) return without_outline("floor_info.json contradicts its outline, and way points lie outside of it");
  map.corner = box.low;
  map.metres_per_unit = *scale;
  const auto to_floor = [&](const MercatorRing& ring) {
    Ring points;
    for (const MercatorPoint p : ring) points.push_back({(p.x - box.low.x) * map.metres_per_unit, (p.y - box.low.y) * map.metres_per_unit});
    return points;
  };
  for (const MercatorRing& ring : outline) map.outline.rings.push_back(to_floor(ring));
  std::vector<Ring> shops;
  std::size_t broken = 0;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!shapes[i].wrong.empty() && broken++ == 0) complain("features[" + std::to_string(i) + "]: " + shapes[i].wrong + "; left out");
    if (i == *chosen) continue;
    for (const MercatorRing& ring : shapes[i].rings) shops.push_back(to_floor(ring));
  }
  if (broken > 1) complain(std::to_string(broken) + " features in all are left out");
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
