#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "admin/cli/survey_file.hpp"
#include "sdk/src/recording/import/text_line.hpp"
#include "wayfuse/proto/codec.hpp"

namespace wayfuse::cli {
namespace {

using Json = nlohmann::json;

/// Lines on which the elements of the document's `features` begin. Precondition: the text is a JSON object.
std::vector<std::size_t> lines_of_features(std::string_view text) {
  std::vector<std::size_t> lines;
  std::size_t line = 1;
  int depth = 0;
  bool quoted = false;
  bool in_features = false;
  std::string word;  // the newest string at depth 1
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') ++line;
    if (quoted) {
      if (c == '\\') ++i;
      else if (c == '"') quoted = false;
      else if (depth == 1) word += c;
      continue;
    }
    if (c == '"') {
      quoted = true;
      if (depth == 1) word.clear();
    }
    if (c == '[' && depth == 1) in_features = word == "features";
    if (c == '{' && depth == 2 && in_features) lines.push_back(line);
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (depth == 1 && c == ']') in_features = false;
  }
  return lines;
}

struct Broken {
  std::string field, cause;
};

// In the building's frame where the feature says so, as exports do; else laid down from the earth.
Json place_of(const Json& feature, const Json& properties, const SurveyFileSettings& settings) {
  Json place = Json::object();
  if (!properties.contains("floor") && !settings.floor) throw Broken{"properties.floor", "is required (or give --floor)"};
  place["floor"] = properties.contains("floor") ? properties["floor"] : Json(settings.floor->value);
  if (properties.contains("x_m") || properties.contains("y_m")) {
    for (const char* name : {"x_m", "y_m"}) {
      if (!properties.contains(name)) throw Broken{std::string("properties.") + name, "is required where the other is given"};
      place[name] = properties[name];
    }
    return place;
  }
  const Json geometry = feature.value("geometry", Json());
  if (!geometry.is_object() || geometry.value("type", Json()) != "Point") throw Broken{"geometry", "must be a Point"};
  const Json coordinates = geometry.value("coordinates", Json());
  const bool pair = coordinates.is_array() && coordinates.size() >= 2 && coordinates[0].is_number() && coordinates[1].is_number();
  if (!pair) throw Broken{"geometry.coordinates", "must be [longitude, latitude]"};
  if (!settings.georeference) {
    throw Broken{"geometry.coordinates", "the building has no georeference, and the feature no x_m and y_m"};
  }
  const GeoPoint geo{coordinates[1].get<double>(), coordinates[0].get<double>()};
  if (std::abs(geo.latitude_deg) > 90 || std::abs(geo.longitude_deg) > 180) throw Broken{"geometry.coordinates", "are outside the earth"};
  const BuildingPoint point = settings.georeference->to_building(geo);
  place["x_m"] = point.x_m;
  place["y_m"] = point.y_m;
  return place;
}

/// The protocol's own decoder reads a point: one parser, one set of limits. Long ones go through it a scan at a time.
ReferencePoint decoded(const Json& point) {
  const auto decode = [](const Json& part) {
    const auto message = decode_client_message(Json{{"type", "survey"}, {"idempotency_key", "k"}, {"points", {part}}}.dump(), Encoding::kJson);
    if (message) return std::get<SurveyBatch>(*message).points.front();
    std::string field = message.fault().field;
    for (const std::string_view wrapping : {"points[0].place.", "points[0].", "points[0]"}) {
      if (!field.starts_with(wrapping)) continue;
      field.erase(0, wrapping.size());
      break;
    }
    throw Broken{field.empty() ? "properties" : "properties." + field, message.fault().cause};
  };
  const Json& scans = point["scans"];
  if (!scans.is_array() || scans.size() < 2) return decode(point);
  Json part = point;
  part["scans"] = Json::array({scans[0]});
  ReferencePoint whole = decode(part);
  for (std::size_t i = 1; i < scans.size(); ++i) {
    part["scans"] = Json::array({scans[i]});
    try {
      whole.scans.push_back(decode(part).scans.front());
    } catch (Broken& broken) {
      if (const auto at = broken.field.find("scans[0]"); at != std::string::npos) broken.field.replace(at, 8, "scans[" + std::to_string(i) + "]");
      throw;
    }
  }
  if (const auto good = check(whole, "properties"); !good) throw Broken{good.fault().field, good.fault().cause};
  return whole;
}

ReferencePoint point_of(const Json& feature, const SurveyFileSettings& settings, UnixTime written) {
  if (!feature.is_object() || feature.value("type", Json()) != "Feature") throw Broken{"type", "must be Feature"};
  const Json properties = feature.value("properties", Json::object());
  if (!properties.is_object()) throw Broken{"properties", "must be an object"};
  if (!properties.contains("scans") || !properties["scans"].is_array()) {
    throw Broken{"properties.scans", "must be a list of scans, each {time_us, readings}"};
  }
  Json point{{"place", place_of(feature, properties, settings)}, {"scans", properties["scans"]}};
  for (const char* name : {"sigma_m", "device_model", "walk", "surveyed_at_us"}) {
    if (properties.contains(name)) point[name] = properties[name];
  }
  if (!point.contains("surveyed_at_us")) point["surveyed_at_us"] = written.time_since_epoch().count();
  if (!point.contains("device_model")) point["device_model"] = settings.device_model;
  return decoded(point);
}

}  // namespace

Result<SurveyFile> read_points_geojson(const std::string& path, const SurveyFileSettings& settings) {
  auto text = TextFile::read(path);
  if (!text) return text.fault();
  std::string whole;
  while (const auto line = text->next_line()) whole.append(*line).push_back('\n');
  Json document;
  try {
    document = Json::parse(whole);
  } catch (const Json::exception& broken) {  // numbers beyond a double too
    std::string cause = broken.what();  // names line and column, and shows what stood there
    std::ranges::replace_if(cause, [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
    return Fault{FaultCode::kMalformed, path, cause.substr(0, 300)};
  }
  if (!document.is_object() || document.value("type", Json()) != "FeatureCollection" || !document.contains("features") || !document["features"].is_array()) {
    return Fault{FaultCode::kWrongType, path, "is no FeatureCollection"};
  }
  SurveyFile file;
  const UnixTime written = written_at(path);
  const auto lines = lines_of_features(whole);
  for (std::size_t i = 0; i < document["features"].size(); ++i) {
    ++file.rows;
    try {
      file.points.push_back(point_of(document["features"][i], settings, written));
    } catch (const Broken& broken) {
      file.bad.push_back({path, i < lines.size() ? lines[i] : 0, "features[" + std::to_string(i) + "]." + broken.field, broken.cause});
    }
  }
  return file;
}

}  // namespace wayfuse::cli
