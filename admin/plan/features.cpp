#include "admin/plan/features.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;  // of labels the first language counts

constexpr std::size_t kMostFeatures = 100'000;
constexpr std::size_t kMostCoordinates = 2'000'000;
constexpr std::size_t kLongestText = 256;

struct Broken {
  Fault fault;
};
[[noreturn]] void broken(const std::string& where, std::string cause) { throw Broken{{FaultCode::kMalformed, where, std::move(cause)}}; }

class Reader {
 public:
  Feature feature(const Json& json, std::string where) {
    if (!json.is_object() || json.value("type", "") != "Feature") broken(where, "is no Feature");
    Feature feature;
    feature.where = std::move(where);
    if (const auto id = json.find("id"); id != json.end()) feature.id = text_of(*id);
    if (const auto properties = json.find("properties"); properties != json.end() && properties->is_object()) {
      for (const auto& [name, value] : properties->items()) {
        if (std::string text = text_of(value); !text.empty()) feature.properties[name] = std::move(text);
      }
    }
    if (feature.id.empty()) feature.id = feature.property({"id"});
    if (!feature.id.empty()) feature.where += " " + plain(feature.id.substr(0, 36));
    if (const auto geometry = json.find("geometry"); geometry != json.end() && geometry->is_object()) take_geometry(*geometry, feature);
    return feature;
  }

 private:
  // What goes into reports and faults.
  static std::string plain(std::string text) {
    std::ranges::replace_if(text, [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
    return text;
  }

  // A scalar as text, of a label in several languages the first.
  static std::string text_of(const Json& value) {
    std::string text;
    if (value.is_string()) text = value.get<std::string>();
    if (value.is_number()) text = value.dump();
    if (value.is_boolean()) text = value.get<bool>() ? "true" : "false";
    if (value.is_object() && !value.empty() && value.front().is_string()) text = value.front().get<std::string>();
    std::erase_if(text, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
    while (text.size() > kLongestText || (!text.empty() && text.size() == kLongestText && (static_cast<unsigned char>(text.back()) & 0xc0) == 0x80)) text.pop_back();
    return text;
  }

  void take_geometry(const Json& geometry, Feature& feature) {
    feature.has_geometry = true;
    const std::string type = geometry.value("type", "");
    if (type == "GeometryCollection") {
      for (const Json& part : geometry.value("geometries", Json::array())) {
        if (part.is_object()) take_geometry(part, feature);
      }
      return;
    }
    const auto coordinates = geometry.find("coordinates");
    if (coordinates == geometry.end() || !coordinates->is_array()) broken(feature.where, "geometry.coordinates: a list expected");
    if (type == "Polygon") feature.polygons.push_back(rings(*coordinates, feature.where));
    if (type == "MultiPolygon") {
      for (const Json& part : *coordinates) feature.polygons.push_back(rings(part, feature.where));
    }
    if (type == "LineString") feature.lines.push_back(line(*coordinates, feature.where));
    if (type == "MultiLineString") feature.lines = rings(*coordinates, feature.where);
  }

  std::vector<RawLine> rings(const Json& json, const std::string& where) {
    if (!json.is_array()) broken(where, "geometry.coordinates: a list of rings expected");
    std::vector<RawLine> rings;
    for (const Json& ring : json) rings.push_back(line(ring, where));
    return rings;
  }

  RawLine line(const Json& json, const std::string& where) {
    if (!json.is_array()) broken(where, "geometry.coordinates: a list of positions expected");
    RawLine line;
    for (const Json& position : json) {
      if (!position.is_array() || position.size() < 2 || !position[0].is_number() || !position[1].is_number()) {
        broken(where, "geometry.coordinates: a position is [longitude, latitude]");
      }
      const RawPoint point{position[0].get<double>(), position[1].get<double>()};
      if (!std::isfinite(point.x) || !std::isfinite(point.y) || std::abs(point.x) > 1e9 || std::abs(point.y) > 1e9) {
        broken(where, "geometry.coordinates: not a place on earth");
      }
      if (++coordinates_ > kMostCoordinates) broken(where, "more than 2000000 coordinates in all");
      line.push_back(point);
    }
    return line;
  }

  std::size_t coordinates_ = 0;
};

}  // namespace

std::string Feature::property(std::initializer_list<const char*> names, bool lower) const {
  for (const char* name : names) {
    const auto found = properties.find(name);
    if (found == properties.end()) continue;
    std::string text = found->second;
    if (lower) std::ranges::transform(text, text.begin(), [](unsigned char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : static_cast<char>(c); });
    return text;
  }
  return {};
}

Result<FeatureCollection> read_features(std::string_view text, const std::string& name) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return Fault{FaultCode::kMalformed, name, "is not JSON"};
  const auto features = json.is_object() ? json.find("features") : json.end();
  if (!json.is_object() || json.value("type", "") != "FeatureCollection" || features == json.end() || !features->is_array()) {
    return Fault{FaultCode::kMalformed, name, "is no FeatureCollection"};
  }
  if (features->size() > kMostFeatures) return Fault{FaultCode::kTooLarge, name, "more than 100000 features"};
  FeatureCollection collection;
  if (const auto crs = json.find("crs"); crs != json.end() && crs->is_object()) {
    const auto properties = crs->find("properties");
    if (properties != crs->end() && properties->is_object()) {
      const auto called = properties->find("name");
      if (called != properties->end() && called->is_string()) collection.crs = called->get<std::string>();
    }
  }
  try {
    Reader reader;
    for (const Json& feature : *features) {
      collection.features.push_back(reader.feature(feature, name + "[" + std::to_string(collection.features.size()) + "]"));
    }
  } catch (const Broken& stop) {
    return stop.fault;
  } catch (const Json::exception& unfit) {  // a member of another type than GeoJSON gives it
    return Fault{FaultCode::kMalformed, name, unfit.what()};
  }
  return collection;
}

}  // namespace wayfuse
