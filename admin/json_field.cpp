#include "admin/json_field.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFarthest_m = 1e5;
constexpr std::size_t kMostPolygons = 20000;
constexpr std::size_t kMostPoints = 20000;

const Json& json(const void* value) { return *static_cast<const Json*>(value); }

std::string join(const std::string& path, std::string_view name) { return path.empty() ? std::string(name) : path + "." + std::string(name); }
std::string at(const std::string& path, std::size_t index) { return path + "[" + std::to_string(index) + "]"; }

}  // namespace

JsonField JsonField::object_in(std::string_view text) {
  const auto document = std::make_shared<const Json>(Json::parse(text, nullptr, false));
  const JsonField whole(document, document.get(), "");
  if (document->is_discarded()) whole.refuse(FaultCode::kMalformed, "the body is not JSON");
  if (!document->is_object()) whole.refuse(FaultCode::kWrongType, "the body must be a JSON object");
  return whole;
}

bool JsonField::is_null() const { return json(value_).is_null(); }
bool JsonField::is_text() const { return json(value_).is_string(); }

void JsonField::must_be_object() const {
  if (!json(value_).is_object()) refuse(FaultCode::kWrongType, "must be an object");
}

JsonField JsonField::member(const char* name) const {
  must_be_object();
  const auto found = json(value_).find(name);
  if (found == json(value_).end()) throw Broken{{FaultCode::kMissingField, join(path_, name), "is required"}};
  return below(&*found, join(path_, name));
}

bool JsonField::has(const char* name) const {
  must_be_object();
  return json(value_).contains(name);
}

std::optional<JsonField> JsonField::maybe(const char* name) const {
  must_be_object();
  const auto found = json(value_).find(name);
  if (found == json(value_).end() || found->is_null()) return std::nullopt;
  return below(&*found, join(path_, name));
}

double JsonField::number(double least, double most) const {
  if (!json(value_).is_number()) refuse(FaultCode::kWrongType, "must be a number");
  const double value = json(value_).get<double>();
  if (!std::isfinite(value) || value < least || value > most) {
    char cause[96];
    std::snprintf(cause, sizeof cause, "%g is outside %g..%g", value, least, most);
    refuse(FaultCode::kOutOfRange, cause);
  }
  return value;
}

std::int64_t JsonField::whole(std::int64_t least, std::int64_t most) const {
  const double value = number(static_cast<double>(least), static_cast<double>(most));
  if (value != std::floor(value)) refuse(FaultCode::kOutOfRange, "must be a whole number");
  return static_cast<std::int64_t>(value);
}

// nlohmann has checked UTF-8; what is left are control characters and length.
std::string JsonField::text(std::size_t most_bytes) const {
  if (!is_text()) refuse(FaultCode::kWrongType, "must be a text");
  auto value = json(value_).get<std::string>();
  if (value.size() > most_bytes) refuse(FaultCode::kTooLarge, "is longer than " + std::to_string(most_bytes) + " bytes");
  for (const unsigned char c : value) {
    if (c < 0x20 || c == 0x7f) refuse(FaultCode::kBadText, "holds control characters");
  }
  return value;
}

bool JsonField::flag() const {
  if (!json(value_).is_boolean()) refuse(FaultCode::kWrongType, "must be true or false");
  return json(value_).get<bool>();
}

std::vector<JsonField> JsonField::list(std::size_t most) const {
  if (!json(value_).is_array()) refuse(FaultCode::kWrongType, "must be a list");
  if (json(value_).size() > most) refuse(FaultCode::kTooLarge, "has more than " + std::to_string(most) + " entries");
  std::vector<JsonField> entries;
  for (const Json& entry : json(value_)) entries.push_back(below(&entry, at(path_, entries.size())));
  return entries;
}

double JsonField::number(const char* name, double standard, double least, double most) const {
  const auto found = maybe(name);
  return found ? found->number(least, most) : standard;
}

std::string JsonField::text(const char* name, std::string standard, std::size_t most_bytes) const {
  const auto found = maybe(name);
  return found ? found->text(most_bytes) : std::move(standard);
}

bool JsonField::flag(const char* name, bool standard) const {
  const auto found = maybe(name);
  return found ? found->flag() : standard;
}

GeoPoint JsonField::geo_point() const { return {member("latitude_deg").number(-90, 90), member("longitude_deg").number(-180, 180)}; }

std::vector<BuildingPoint> JsonField::points() const {
  std::vector<BuildingPoint> points;
  for (const JsonField& point : list(kMostPoints)) {
    const Json& pair = json(point.value_);
    if (!pair.is_array() || pair.size() != 2) point.refuse(FaultCode::kWrongType, "a point is [x_m, y_m]");
    points.push_back({below(&pair[0], point.path_).number(-kFarthest_m, kFarthest_m), below(&pair[1], point.path_).number(-kFarthest_m, kFarthest_m)});
  }
  return points;
}

Ring JsonField::ring() const {
  Ring ring = points();
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (ring.size() < 3) refuse(FaultCode::kOutOfRange, "a ring has at least three different points");
  return ring;
}

Polyline JsonField::line() const {
  Polyline line = points();
  if (line.size() < 2) refuse(FaultCode::kOutOfRange, "a line has at least two points");
  return line;
}

Polygon JsonField::polygon() const {
  Polygon polygon;
  for (const JsonField& entry : list(kMostPolygons)) polygon.rings.push_back(entry.ring());
  return polygon;
}

std::vector<Polygon> JsonField::polygons() const {
  std::vector<Polygon> polygons;
  for (const JsonField& entry : list(kMostPolygons)) polygons.push_back(entry.polygon());
  return polygons;
}

}  // namespace wayfuse
