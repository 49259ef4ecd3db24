#include "server/buildings/map_versions.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "db/content_hash.hpp"
#include "server/buildings/device_offsets.hpp"

namespace wayfuse {
namespace {

constexpr int kFormat = 1;
constexpr std::size_t kDevicesTold = 100;  // those that surveyed most; the recipe is bounded

MapManifest manifest_of(const std::vector<ReferencePoint>& points, std::vector<Bssid> distrusted, const std::vector<DeviceLevel>& devices) {
  MapManifest manifest{points.size(), 0, hex(hash_of_points(points)), std::move(distrusted), offsets_of(devices)};
  for (const ReferencePoint& point : points) {
    for (const RssScan& scan : point.scans) manifest.readings += scan.readings.size();
  }
  return manifest;
}

double rounded_to_hundredths(double value) { return std::round(value * 100.0) / 100.0; }

nlohmann::json json_of(const std::vector<DeviceLevel>& devices) {
  nlohmann::json list = nlohmann::json::array();
  for (const DeviceLevel& device : devices) {
    if (list.size() == kDevicesTold) break;
    list.push_back({{"model", device.model},
                    {"points", device.points},
                    {"standing", name_of(device.standing)},
                    {"offset_db", rounded_to_hundredths(device.offset_db)},
                    {"places", device.places},
                    {"transmitters", device.transmitters}});
  }
  return list;
}

}  // namespace

std::string to_content(const MapManifest& manifest) {
  nlohmann::json distrusted = nlohmann::json::array();
  for (const Bssid bssid : manifest.distrusted) distrusted.push_back(to_string(bssid));
  return nlohmann::json{{"format", kFormat},
                        {"points", manifest.points},
                        {"readings", manifest.readings},
                        {"survey_blake2b", manifest.survey_hash},
                        {"distrusted", std::move(distrusted)},
                        {"device_offsets_db", manifest.device_offsets_db}}
      .dump();
}

Result<MapManifest> parse_manifest(std::string_view content) {
  const Fault broken{FaultCode::kStoreCorrupt, "radio map", "its content is no manifest this wayfuse knows"};
  const auto json = nlohmann::json::parse(content, nullptr, false);
  if (!json.is_object() || json.value("format", 0) != kFormat) return broken;
  try {
    MapManifest manifest{json.at("points").get<std::uint64_t>(), json.at("readings").get<std::uint64_t>(),
                         json.at("survey_blake2b").get<std::string>(), {},
                         json.at("device_offsets_db").get<std::map<std::string, double>>()};
    for (const auto& text : json.at("distrusted")) {
      const auto bssid = parse_bssid(text.get<std::string>());
      if (!bssid) return broken;
      manifest.distrusted.push_back(*bssid);
    }
    return manifest;
  } catch (const nlohmann::json::exception&) {
    return broken;
  }
}

Result<RadioMapRecord> MapVersions::stage(UnixTime now) {
  const auto building = database_.building();
  if (!building) return building.fault();
  const auto points = points_through(building->survey_version);
  if (!points) return points.fault();
  if (points->empty()) return Fault{FaultCode::kEmptyRadioMap, "survey", "the building has no reference points yet"};
  const auto access_points = database_.access_points();
  if (!access_points) return access_points.fault();
  std::vector<Bssid> distrusted;
  for (const AccessPointRecord& record : *access_points) {
    if (record.distrusted()) distrusted.push_back(record.bssid);
  }
  const std::vector<DeviceLevel> devices = learn_device_levels(*points);
  const MapManifest manifest = manifest_of(*points, std::move(distrusted), devices);
  const nlohmann::json recipe{{"format", kFormat},
                              {"points", manifest.points},
                              {"readings", manifest.readings},
                              {"distrusted", manifest.distrusted.size()},
                              {"devices", json_of(devices)}};
  return database_.stage_map({building->survey_version, recipe.dump(), now, to_content(manifest)});
}

Result<MapMaterial> MapVersions::material(const RadioMapRecord& map) {
  const auto content = database_.map_content(map.version);
  if (!content) return content.fault();
  auto manifest = parse_manifest(*content);
  if (!manifest) return manifest.fault();
  auto points = points_through(map.survey_version);
  if (!points) return points.fault();
  auto qualities = database_.qualities(map.version);
  if (!qualities) return qualities.fault();
  const bool whole = points->size() == manifest->points && hex(hash_of_points(*points)) == manifest->survey_hash;
  return MapMaterial{map.version, map.survey_version, *std::move(points), std::move(manifest->distrusted),
                     std::move(manifest->device_offsets_db), *std::move(qualities), {}, whole};
}

Result<MapMaterial> MapVersions::survey_as_it_stands() {
  const auto building = database_.building();
  if (!building) return building.fault();
  auto points = points_through(building->survey_version);
  if (!points) return points.fault();
  return MapMaterial{building->survey_version, building->survey_version, *std::move(points), {}, {}, {}, {}, true};
}

Result<RadioMapRecord> MapVersions::find(std::uint64_t version) {
  const auto maps = database_.maps();
  if (!maps) return maps.fault();
  const auto found = std::ranges::find(*maps, version, &RadioMapRecord::version);
  if (found == maps->end()) return Fault{FaultCode::kNotFound, "version", "there is no radio map " + std::to_string(version)};
  return *found;
}

Result<std::optional<RadioMapRecord>> MapVersions::live() {
  const auto version = database_.live_map();
  if (!version) return version.fault();
  if (!*version) return std::optional<RadioMapRecord>();
  auto map = find(**version);
  if (!map) return map.fault();
  return std::optional<RadioMapRecord>(*std::move(map));
}

Result<bool> MapVersions::automatic(const BuildingRecord& building) {
  if (building.publication != PublicationPolicy::kAutomatic) return false;
  const auto publications = database_.publications();
  if (!publications) return publications.fault();
  if (publications->empty()) return true;
  const Publication& newest = publications->back();
  if (newest.act == Publication::Act::kRolledBack) return false;
  if (newest.by_key == 0) return true;
  const auto maps = database_.maps();
  if (!maps) return maps.fault();
  return newest.version == maps->back().version;
}

Result<bool> MapVersions::is_settled(const RadioMapRecord& map) {
  const auto publications = database_.publications();
  if (!publications) return publications.fault();
  if (!publications->empty() && publications->back().version == map.version) return true;
  if (std::ranges::find(*publications, map.version, &Publication::version) != publications->end()) return false;
  const auto qualities = database_.qualities(map.version);
  if (!qualities) return qualities.fault();
  return !qualities->empty();
}

Result<std::vector<ReferencePoint>> MapVersions::points_through(std::uint64_t survey_version) {
  std::vector<ReferencePoint> points;
  PointQuery query;
  query.through_version = survey_version;
  for (;;) {
    auto page = database_.points(query);
    if (!page) return page.fault();
    if (page->empty()) return points;
    query.after_id = page->back().id;
    for (StoredPoint& stored : *page) points.push_back(std::move(stored.point));
  }
}

}  // namespace wayfuse
