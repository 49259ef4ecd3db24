#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "admin/json_forms.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kFarthest_m = 1e5;
constexpr std::size_t kMostFloors = 256;
constexpr std::size_t kMostPolygons = 20000;
constexpr std::size_t kMostRingPoints = 20000;

// Parsing stops at the first fault; it travels as an exception inside this file only.
struct Broken {
  Fault fault;
};

[[noreturn]] void broken(FaultCode code, std::string field, std::string cause) { throw Broken{{code, std::move(field), std::move(cause)}}; }

std::string join(const std::string& path, std::string_view name) { return path.empty() ? std::string(name) : path + "." + std::string(name); }
std::string at(const std::string& path, std::size_t index) { return path + "[" + std::to_string(index) + "]"; }

const Json& member(const Json& json, const std::string& path, const char* name) {
  const auto found = json.find(name);
  if (found == json.end()) broken(FaultCode::kMissingField, join(path, name), "is required");
  return *found;
}

double number(const Json& json, const std::string& path, double least, double most) {
  if (!json.is_number()) broken(FaultCode::kWrongType, path, "must be a number");
  const double value = json.get<double>();
  if (!std::isfinite(value) || value < least || value > most) {
    char cause[96];
    std::snprintf(cause, sizeof cause, "%g is outside %g..%g", value, least, most);
    broken(FaultCode::kOutOfRange, path, cause);
  }
  return value;
}

double optional_number(const Json& json, const std::string& path, const char* name, double standard, double least, double most) {
  const auto found = json.find(name);
  return found == json.end() || found->is_null() ? standard : number(*found, join(path, name), least, most);
}

// nlohmann has checked UTF-8; what is left are control characters and length.
std::string text(const Json& json, const std::string& path, std::size_t most) {
  if (!json.is_string()) broken(FaultCode::kWrongType, path, "must be a text");
  auto value = json.get<std::string>();
  if (value.size() > most) broken(FaultCode::kTooLarge, path, "is longer than " + std::to_string(most) + " bytes");
  for (const unsigned char c : value) {
    if (c < 0x20 || c == 0x7f) broken(FaultCode::kBadText, path, "holds control characters");
  }
  return value;
}

const Json& list(const Json& json, const std::string& path, std::size_t most) {
  if (!json.is_array()) broken(FaultCode::kWrongType, path, "must be a list");
  if (json.size() > most) broken(FaultCode::kTooLarge, path, "has more than " + std::to_string(most) + " entries");
  return json;
}

Ring ring_of(const Json& json, const std::string& path) {
  Ring ring;
  for (std::size_t i = 0; const Json& point : list(json, path, kMostRingPoints)) {
    if (!point.is_array() || point.size() != 2) broken(FaultCode::kWrongType, at(path, i), "a point is [x_m, y_m]");
    ring.push_back({number(point[0], at(path, i), -kFarthest_m, kFarthest_m), number(point[1], at(path, i), -kFarthest_m, kFarthest_m)});
    ++i;
  }
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (ring.size() < 3) broken(FaultCode::kOutOfRange, path, "a ring has at least three different points");
  return ring;
}

Polygon polygon_of(const Json& json, const std::string& path) {
  Polygon polygon;
  for (std::size_t i = 0; const Json& ring : list(json, path, kMostPolygons)) polygon.rings.push_back(ring_of(ring, at(path, i++)));
  return polygon;
}

Floor floor_of(const Json& json, const std::string& path) {
  if (!json.is_object()) broken(FaultCode::kWrongType, path, "must be an object");
  Floor floor;
  const double ordinal = number(member(json, path, "ordinal"), join(path, "ordinal"), -100, 300);
  if (ordinal != std::floor(ordinal)) broken(FaultCode::kOutOfRange, join(path, "ordinal"), "must be a whole number");
  floor.ordinal = {static_cast<std::int32_t>(ordinal)};
  floor.label = json.contains("label") ? text(json["label"], join(path, "label"), 64) : std::to_string(floor.ordinal.value);
  if (json.contains("outline")) floor.outline = polygon_of(json["outline"], join(path, "outline"));
  if (json.contains("walkable")) {
    const std::string here = join(path, "walkable");
    for (std::size_t i = 0; const Json& polygon : list(json["walkable"], here, kMostPolygons)) {
      floor.walkable.push_back(polygon_of(polygon, at(here, i++)));
    }
  }
  return floor;
}

std::vector<Floor> floors_of(const Json& json) {
  std::vector<Floor> floors;
  std::set<FloorOrdinal> seen;
  for (std::size_t i = 0; const Json& entry : list(json, "floors", kMostFloors)) {
    floors.push_back(floor_of(entry, at("floors", i)));
    if (!seen.insert(floors.back().ordinal).second) {
      broken(FaultCode::kConflict, at("floors", i) + ".ordinal", std::to_string(floors.back().ordinal.value) + " stands twice");
    }
    ++i;
  }
  return floors;
}

Georeference georeference_of(const Json& json) {
  const std::string path = "georeference";
  if (!json.is_object()) broken(FaultCode::kWrongType, path, "must be an object");
  const Json& origin = member(json, path, "origin");
  if (!origin.is_object()) broken(FaultCode::kWrongType, path + ".origin", "must be an object");
  const std::string there = path + ".origin";
  return {{number(member(origin, there, "latitude_deg"), there + ".latitude_deg", -90, 90),
           number(member(origin, there, "longitude_deg"), there + ".longitude_deg", -180, 180)},
          kDegree * optional_number(json, path, "y_axis_azimuth_deg", 0, -360, 360)};
}

MagneticField field_of(const Json& json) {
  const std::string path = "magnetic_field";
  if (!json.is_object()) broken(FaultCode::kWrongType, path, "must be an object");
  return {kDegree * optional_number(json, path, "declination_deg", 0, -180, 180),
          kDegree * optional_number(json, path, "dip_deg", 0, -90, 90), optional_number(json, path, "norm_ut", 0, 0, 100)};
}

Json parse_object(std::string_view json) {
  Json parsed = Json::parse(json, nullptr, false);
  if (parsed.is_discarded()) broken(FaultCode::kMalformed, "", "the body is not JSON");
  if (!parsed.is_object()) broken(FaultCode::kWrongType, "", "the body must be a JSON object");
  return parsed;
}

Json to_json(const Polygon& polygon) {
  Json rings = Json::array();
  for (const Ring& ring : polygon.rings) {
    Json points = Json::array();
    for (const BuildingPoint& point : ring) points.push_back({point.x_m, point.y_m});
    rings.push_back(std::move(points));
  }
  return rings;
}

Json to_json(const Floor& floor) {
  Json walkable = Json::array();
  for (const Polygon& polygon : floor.walkable) walkable.push_back(to_json(polygon));
  return {{"ordinal", floor.ordinal.value}, {"label", floor.label}, {"outline", to_json(floor.outline)}, {"walkable", std::move(walkable)}};
}

Json summary_of(const BuildingRecord& building) {
  return {{"id", building.id.value}, {"name", building.name}, {"pipeline", building.pipeline}, {"survey_version", building.survey_version}};
}

}  // namespace

Result<BuildingRecord> parse_building(std::string_view json) {
  try {
    const Json parsed = parse_object(json);
    BuildingRecord building;
    building.name = text(member(parsed, "", "name"), "name", 256);
    if (building.name.empty()) broken(FaultCode::kOutOfRange, "name", "must not be empty");
    if (parsed.contains("georeference") && !parsed["georeference"].is_null()) building.georeference = georeference_of(parsed["georeference"]);
    if (parsed.contains("magnetic_field")) building.magnetic_field = field_of(parsed["magnetic_field"]);
    if (parsed.contains("floors")) building.floors = floors_of(parsed["floors"]);
    if (parsed.contains("pipeline")) building.pipeline = text(parsed["pipeline"], "pipeline", 64);
    return building;
  } catch (const Broken& stop) {
    return stop.fault;
  }
}

Result<std::vector<Floor>> parse_floors(std::string_view json) {
  try {
    const Json parsed = parse_object(json);
    return floors_of(member(parsed, "", "floors"));
  } catch (const Broken& stop) {
    return stop.fault;
  }
}

std::string to_json(const BuildingRecord& building, std::uint64_t points, std::uint64_t radio_map_version) {
  Json json = summary_of(building);
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

std::string to_json(const std::vector<BuildingRecord>& buildings) {
  Json entries = Json::array();
  for (const BuildingRecord& building : buildings) entries.push_back(summary_of(building));
  return Json{{"buildings", std::move(entries)}}.dump();
}

}  // namespace wayfuse
