#include <charconv>
#include <nlohmann/json.hpp>

#include "admin/json_forms.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

std::string number_text(double value) {
  char text[32];  // the shortest spelling that reads back as the same number
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// RFC 4180; a leading =, +, - or @ would be run as a formula by spreadsheets, so such a text is quoted with an apostrophe, and so is
// one that begins with an apostrophe: whoever reads takes one away.
std::string csv_text(const std::string& text) {
  std::string quoted = "\"";
  if (!text.empty() && std::string_view("=+-@'").find(text[0]) != std::string_view::npos) quoted += '\'';
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

Json to_json(const RssScan& scan) {
  Json readings = Json::array();
  for (const ScanReading& reading : scan.readings) {
    Json row{{"bssid", to_string(reading.bssid)}, {"rss_dbm", reading.rss_dbm}, {"age_us", reading.age.count()}};
    if (reading.frequency_mhz != 0) row["frequency_mhz"] = reading.frequency_mhz;
    if (reading.range_m) row["range_m"] = *reading.range_m;
    if (reading.range_sigma_m) row["range_sigma_m"] = *reading.range_sigma_m;
    readings.push_back(std::move(row));
  }
  return {{"time_us", scan.time.time_since_epoch().count()}, {"readings", std::move(readings)}};
}

Json to_json(const StoredPoint& stored) {
  Json scans = Json::array();
  for (const RssScan& scan : stored.point.scans) scans.push_back(to_json(scan));
  return {{"id", stored.id},
          {"place",
           {{"x_m", stored.point.place.point.x_m},
            {"y_m", stored.point.place.point.y_m},
            {"floor", stored.point.place.floor.value}}},
          {"sigma_m", stored.point.sigma_m},
          {"device_model", stored.point.device_model},
          {"walk", stored.point.walk},
          {"surveyed_at_us", stored.point.surveyed_at.time_since_epoch().count()},
          {"scans", std::move(scans)}};
}

}  // namespace

std::string to_json(const std::vector<StoredPoint>& points, std::uint64_t next) {
  Json entries = Json::array();
  for (const StoredPoint& point : points) entries.push_back(to_json(point));
  Json json{{"points", std::move(entries)}};
  if (next != 0) json["next"] = next;
  return json.dump();
}

std::string to_json(const std::vector<UploadRecord>& uploads, std::uint64_t next) {
  Json items = Json::array();
  for (const UploadRecord& upload : uploads) {
    items.push_back({{"id", upload.id}, {"idempotency_key", upload.idempotency_key}, {"points", upload.points}, {"survey_version", upload.survey_version}});
  }
  Json json{{"items", std::move(items)}};
  if (next != 0) json["next"] = next;
  return json.dump();
}

std::string points_csv_header() {
  return "point,x_m,y_m,floor,sigma_m,device_model,walk,surveyed_at_us,scan,scan_time_us,bssid,rss_dbm,age_us,frequency_mhz,range_m,range_sigma_m\r\n";
}

std::string to_csv(const StoredPoint& stored) {
  const ReferencePoint& point = stored.point;
  const std::string head = std::to_string(stored.id) + ',' + number_text(point.place.point.x_m) + ',' +
                           number_text(point.place.point.y_m) + ',' + std::to_string(point.place.floor.value) + ',' +
                           number_text(point.sigma_m) + ',' + csv_text(point.device_model) + ',' + csv_text(point.walk) + ',' +
                           std::to_string(point.surveyed_at.time_since_epoch().count()) + ',';
  std::string rows;
  for (std::size_t i = 0; i < point.scans.size(); ++i) {
    const std::string scan = head + std::to_string(i) + ',' + std::to_string(point.scans[i].time.time_since_epoch().count()) + ',';
    if (point.scans[i].readings.empty()) rows += scan + ",,,,,\r\n";  // it heard nothing, which says something
    for (const ScanReading& reading : point.scans[i].readings) {
      rows += scan + to_string(reading.bssid) + ',' + number_text(reading.rss_dbm) + ',' + std::to_string(reading.age.count()) + ',' +
              std::to_string(reading.frequency_mhz) + ',' + (reading.range_m ? number_text(*reading.range_m) : "") + ',' +
              (reading.range_sigma_m ? number_text(*reading.range_sigma_m) : "") + "\r\n";
    }
  }
  return rows;
}

std::string to_geojson_feature(const StoredPoint& stored, const Georeference& georeference) {
  const GeoPoint geo = georeference.to_geo(stored.point.place.point);
  Json scans = Json::array();
  for (const RssScan& scan : stored.point.scans) scans.push_back(to_json(scan));
  const Json feature{{"type", "Feature"},
                     {"id", stored.id},
                     {"geometry", {{"type", "Point"}, {"coordinates", {geo.longitude_deg, geo.latitude_deg}}}},
                     {"properties",
                      {{"floor", stored.point.place.floor.value},
                       {"x_m", stored.point.place.point.x_m},
                       {"y_m", stored.point.place.point.y_m},
                       {"sigma_m", stored.point.sigma_m},
                       {"device_model", stored.point.device_model},
                       {"walk", stored.point.walk},
                       {"surveyed_at_us", stored.point.surveyed_at.time_since_epoch().count()},
                       {"scans", std::move(scans)}}}};
  return feature.dump();
}

std::string to_json(const std::vector<TransmitterRecord>& transmitters) {
  Json entries = Json::array();
  for (const TransmitterRecord& transmitter : transmitters) {
    entries.push_back({{"bssid", to_string(transmitter.bssid)},
                       {"frequency_mhz", transmitter.frequency_mhz},
                       {"readings", transmitter.readings},
                       {"strongest_dbm", transmitter.strongest_dbm}});
  }
  return Json{{"transmitters", std::move(entries)}}.dump();
}

std::string to_json(const SurveyAck& ack) {
  return Json{{"idempotency_key", ack.idempotency_key}, {"stored", ack.stored}, {"survey_version", ack.survey_version}}.dump();
}

}  // namespace wayfuse
