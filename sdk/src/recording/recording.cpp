#include "wayfuse/sdk/recording.hpp"

#include <cmath>
#include <cstdint>
#include <istream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ostream>
#include <stdexcept>

namespace wayfuse {
namespace {

using Json = nlohmann::json;

constexpr int kVersion = 1;
constexpr std::int64_t kMostInteger = (std::int64_t{1} << 53) - 1;  // exact in a double, as on the wire
constexpr double kDegree = std::numbers::pi / 180.0;

Json to_json(const Vector3& v) { return Json::array({v.x, v.y, v.z}); }

Vector3 vector_of(const Json& json) { return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()}; }

Json to_json(const MargSample& sample) {
  Json json{{"type", "marg"}};
  if (sample.acceleration_mps2) json["acceleration_mps2"] = to_json(*sample.acceleration_mps2);
  if (sample.turn_rate_radps) json["turn_rate_radps"] = to_json(*sample.turn_rate_radps);
  if (sample.field_ut) json["field_ut"] = to_json(*sample.field_ut);
  if (sample.pressure_hpa) json["pressure_hpa"] = *sample.pressure_hpa;
  return json;
}

Json to_json(const RssScan& scan) {
  Json readings = Json::array();
  for (const ScanReading& reading : scan.readings) {
    Json row{{"bssid", to_string(reading.bssid)}, {"rss_dbm", reading.rss_dbm}, {"age_us", reading.age.count()}};
    if (reading.frequency_mhz) row["frequency_mhz"] = reading.frequency_mhz;
    if (reading.range_m) row["range_m"] = *reading.range_m;
    if (reading.range_sigma_m) row["range_sigma_m"] = *reading.range_sigma_m;
    readings.push_back(std::move(row));
  }
  return {{"type", "scan"}, {"readings", std::move(readings)}};
}

Json to_json(const GnssFix& fix) {
  Json json{{"type", "gnss"},
            {"latitude_deg", fix.point.latitude_deg},
            {"longitude_deg", fix.point.longitude_deg},
            {"sigma_m", fix.sigma_m}};
  if (fix.speed_mps) json["speed_mps"] = *fix.speed_mps;
  if (fix.course_azimuth_rad) json["course_azimuth_deg"] = *fix.course_azimuth_rad / kDegree;
  return json;
}

Json to_json(const TruthMark& mark) {
  return {{"type", "truth"}, {"x_m", mark.place.point.x_m}, {"y_m", mark.place.point.y_m}, {"floor", mark.place.floor.value}};
}

// A conversion from a number beyond the type's range would be undefined: looked at before.
std::int64_t whole(const Json& json, const char* name, std::int64_t least, std::int64_t most) {
  const Json& value = json.at(name);
  const bool integer = value.is_number_integer();
  const bool fits = integer && (!value.is_number_unsigned() || value.get<std::uint64_t>() <= static_cast<std::uint64_t>(most));
  if (!fits || value.get<std::int64_t>() < least || value.get<std::int64_t>() > most) {
    throw std::invalid_argument(std::string(name) + " must be a whole number, " + std::to_string(least) + ".." + std::to_string(most));
  }
  return value.get<std::int64_t>();
}
std::int64_t whole(const Json& json, const char* name, std::int64_t least, std::int64_t most, std::int64_t standard) {
  return json.contains(name) ? whole(json, name, least, most) : standard;
}

std::optional<double> number(const Json& json, const char* name) {
  const auto found = json.find(name);
  return found == json.end() ? std::nullopt : std::optional(found->get<double>());
}

MargSample marg_of(const Json& json, PhoneTime time) {
  MargSample sample{.time = time, .acceleration_mps2 = {}, .turn_rate_radps = {}, .field_ut = {}, .pressure_hpa = {}};
  if (json.contains("acceleration_mps2")) sample.acceleration_mps2 = vector_of(json["acceleration_mps2"]);
  if (json.contains("turn_rate_radps")) sample.turn_rate_radps = vector_of(json["turn_rate_radps"]);
  if (json.contains("field_ut")) sample.field_ut = vector_of(json["field_ut"]);
  sample.pressure_hpa = number(json, "pressure_hpa");
  return sample;
}

RssScan scan_of(const Json& json, PhoneTime time) {
  RssScan scan{time, {}};
  for (const Json& row : json.at("readings")) {
    const auto bssid = parse_bssid(row.at("bssid").get<std::string>());
    if (!bssid) throw std::invalid_argument("readings: a bssid is no address like aa:bb:cc:dd:ee:ff");
    scan.readings.push_back({*bssid, row.at("rss_dbm").get<double>(), Duration{whole(row, "age_us", 0, kMostInteger, 0)},
                             static_cast<std::uint16_t>(whole(row, "frequency_mhz", 0, 65'535, 0)), number(row, "range_m"), number(row, "range_sigma_m")});
  }
  return scan;
}

GnssFix gnss_of(const Json& json, PhoneTime time) {
  GnssFix fix{time, {json.at("latitude_deg").get<double>(), json.at("longitude_deg").get<double>()},
              json.at("sigma_m").get<double>(), number(json, "speed_mps"), number(json, "course_azimuth_deg")};
  if (fix.course_azimuth_rad) *fix.course_azimuth_rad *= kDegree;
  return fix;
}

std::optional<RecordedEvent> event_of(const Json& json) {
  const std::string type = json.at("type").get<std::string>();
  if (type != "marg" && type != "scan" && type != "gnss" && type != "truth") return std::nullopt;
  const PhoneTime time{Duration{whole(json, "time_us", -kMostInteger, kMostInteger)}};
  if (type == "marg") return marg_of(json, time);
  if (type == "scan") return scan_of(json, time);
  if (type == "gnss") return gnss_of(json, time);
  return TruthMark{time, {{json.at("x_m").get<double>(), json.at("y_m").get<double>()}, {static_cast<std::int32_t>(whole(json, "floor", -200, 1000))}}};
}

Fault broken_line(std::size_t line, const std::string& cause) {
  return {FaultCode::kMalformed, "line " + std::to_string(line), cause};
}
// The library's own words quote the bytes it stumbled over, which may be anything.
Fault broken_line(std::size_t line, const Json::parse_error& error) {
  return broken_line(line, "is not JSON at byte " + std::to_string(error.byte));
}
Fault broken_line(std::size_t line, const Json::out_of_range& error) {
  constexpr int kNumberOverflow = 406;
  return broken_line(line, error.id == kNumberOverflow ? "holds a number beyond a double" : error.what());
}

}  // namespace

PhoneTime time_of(const RecordedEvent& event) {
  return std::visit([](const auto& body) { return body.time; }, event);
}

std::string recording_line(const RecordedEvent& event, std::optional<std::uint64_t> sequence) {
  Json json = std::visit([](const auto& body) { return to_json(body); }, event);
  json["time_us"] = time_of(event).time_since_epoch().count();
  if (sequence) json["sequence"] = *sequence;
  return json.dump() + "\n";
}

RecordingWriter::RecordingWriter(std::ostream& out, const RecordingHeader& header) : out_(out) {
  out_ << Json{{"type", "wayfuse-recording"},
               {"version", kVersion},
               {"device_model", header.device_model},
               {"app", header.app},
               {"building", header.building},
               {"started_at_us", header.started_at.time_since_epoch().count()}}
       << '\n';
}

void RecordingWriter::write(const RecordedEvent& event) {
  out_ << recording_line(event);
  if (!out_) throw std::runtime_error("recording: the stream cannot be written");
}

Result<RecordingReader> RecordingReader::open(std::istream& in) {
  std::string line;
  if (!std::getline(in, line)) return broken_line(1, "the recording is empty");
  try {
    const Json json = Json::parse(line);
    if (json.at("type") != "wayfuse-recording") return broken_line(1, "this is no wayfuse recording");
    if (const std::int64_t version = whole(json, "version", 1, kMostInteger); version > kVersion) {
      return Fault{FaultCode::kUnsupportedVersion, "line 1", "version " + std::to_string(version) + " is newer than " +
                                                                 std::to_string(kVersion)};
    }
    RecordingHeader header{json.value("device_model", ""), json.value("app", ""), json.value("building", ""),
                           UnixTime{Duration{whole(json, "started_at_us", 0, kMostInteger, 0)}}};
    return RecordingReader(in, std::move(header));
  } catch (const Json::parse_error& error) {
    return broken_line(1, error);
  } catch (const Json::out_of_range& error) {
    return broken_line(1, error);
  } catch (const std::exception& error) {
    return broken_line(1, error.what());
  }
}

Result<std::optional<RecordedEvent>> RecordingReader::next() {
  for (std::string line; std::getline(*in_, line);) {
    ++line_;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    try {
      if (auto event = event_of(Json::parse(line))) return event;
    } catch (const Json::parse_error& error) {
      return broken_line(line_, error);
    } catch (const Json::out_of_range& error) {
      return broken_line(line_, error);
    } catch (const std::exception& error) {
      return broken_line(line_, error.what());
    }
  }
  return std::optional<RecordedEvent>{};
}

}  // namespace wayfuse
