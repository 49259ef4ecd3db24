#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "sdk/src/recording/import/import.hpp"
#include "sdk/src/recording/import/text_line.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse {
namespace {

constexpr double kAgeMost_s = 600.0;          // the contract's bound for ScanReading::age
constexpr double kTimeMost_s = 1e9;
constexpr double kDegree = std::numbers::pi / 180.0;

PhoneTime at(double time_s) { return PhoneTime(from_seconds(time_s)); }

/// One sensor's rows: their own clock against the application's.
struct Stamped {
  double app_s = 0.0;
  double sensor_s = 0.0;
};

/// The least delay from a sensor's stamp to the application's; rows without a stamp of their own keep the application's time.
class Clock {
 public:
  void note(Stamped stamp) {
    if (stamp.sensor_s > 0.0) offset_s_ = std::min(offset_s_, stamp.app_s - stamp.sensor_s);
  }
  double time_s(Stamped stamp) const {
    return stamp.sensor_s > 0.0 && known() ? stamp.sensor_s + offset_s_ : stamp.app_s;
  }
  bool known() const { return offset_s_ < std::numeric_limits<double>::infinity(); }

 private:
  double offset_s_ = std::numeric_limits<double>::infinity();
};

struct SensorRow {
  std::size_t sensor;   // index into kSensors
  Stamped stamp;
  Vector3 value;
};
struct WifiRow {
  Stamped stamp;
  ScanReading reading;
};
struct PlaceRow {
  double time_s;
  GeoPoint point;
  FloorOrdinal floor;
};

constexpr std::array<std::string_view, 4> kSensors = {"ACCE", "GYRO", "MAGN", "PRES"};

class LogReader {
 public:
  /// Empty = taken, or a kind we do not use; otherwise why not.
  std::string line(const std::vector<std::string_view>& fields);
  ImportedRecording finish(const std::string& path, const ImportSettings& settings);

 private:
  std::string sensor(std::size_t which, const std::vector<std::string_view>& fields);
  std::string wifi(const std::vector<std::string_view>& fields);
  std::string satellites(const std::vector<std::string_view>& fields);
  std::string place(const std::vector<std::string_view>& fields);
  void add_scans(std::vector<RecordedEvent>& events) const;

  std::vector<SensorRow> sensors_;
  std::array<Clock, kSensors.size()> clocks_;
  Clock any_;   // of all sensors together: Wi-Fi is stamped since boot, as they are
  std::vector<WifiRow> wifi_;
  std::vector<GnssFix> fixes_;
  std::vector<PlaceRow> places_;
};

std::string LogReader::line(const std::vector<std::string_view>& fields) {
  const std::string_view kind = fields[0];
  const auto which = std::find(kSensors.begin(), kSensors.end(), kind);
  if (which != kSensors.end()) return sensor(static_cast<std::size_t>(which - kSensors.begin()), fields);
  if (kind == "WIFI") return wifi(fields);
  if (kind == "GNSS") return satellites(fields);
  if (kind == "POSI") return place(fields);
  const bool known_shape = kind.size() == 4 && std::ranges::all_of(kind, [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); });
  return known_shape ? "" : "unknown kind of line";
}

// ACCE;app;sensor;x;y;z;accuracy, PRES;app;sensor;mbar;accuracy
std::string LogReader::sensor(std::size_t which, const std::vector<std::string_view>& fields) {
  const bool pressure = kSensors[which] == "PRES";
  std::array<double, 5> v{};
  if (!numbers(fields, 1, std::span(v.data(), pressure ? 3 : 5))) return "app time, sensor time and the sensor's values expected";
  if (v[0] < 0 || v[0] > kTimeMost_s || v[1] < 0 || v[1] > kTimeMost_s) return "a time is outside 0..1e9 s";
  const Stamped stamp{v[0], v[1]};
  clocks_[which].note(stamp);
  if (!pressure) any_.note(stamp);
  sensors_.push_back({which, stamp, {v[2], v[3], v[4]}});
  return "";
}

// WIFI;app;sensor;ssid;bssid;[MHz;]dBm. The name may hold anything, semicolons too: count from the end.
std::string LogReader::wifi(const std::vector<std::string_view>& whole) {
  std::vector<std::string_view> fields = whole;
  while (fields.size() > 6 && fields.back().empty()) fields.pop_back();
  std::array<double, 2> times{};
  if (fields.size() < 6 || !numbers(fields, 1, times)) return "app time, sensor time, ssid, bssid, frequency and rss expected";
  const std::size_t last = fields.size() - 1;
  const auto rss = number(fields[last]);
  if (!rss || *rss < -120.0 || *rss > 0.0) return "rss " + shown(fields[last]) + " is outside -120..0 dBm";
  auto bssid = parse_bssid(fields[last - 1]);   // logs before 2019 tell no frequency
  std::optional<std::int64_t> frequency;
  if (!bssid) {
    bssid = parse_bssid(fields[last - 2]);
    frequency = whole_number(fields[last - 1]);
    if (!bssid) return "not a BSSID: " + shown(fields[last - 2]);
    if (!frequency || *frequency < 0 || *frequency > 65'535) return "not a frequency: " + shown(fields[last - 1]);
  }
  if (times[0] < 0 || times[0] > kTimeMost_s) return "the app time is outside 0..1e9 s";
  wifi_.push_back({{times[0], times[1]}, {*bssid, *rss, Duration{0}, static_cast<std::uint16_t>(frequency.value_or(0)), {}, {}}});
  return "";
}

// GNSS;app;sensor;lat;lon;altitude;bearing;accuracy;speed;..
std::string LogReader::satellites(const std::vector<std::string_view>& fields) {
  std::array<double, 8> v{};
  if (!numbers(fields, 1, v)) return "app time, sensor time, latitude, longitude, altitude, bearing, accuracy and speed expected";
  if (v[0] < 0 || v[0] > kTimeMost_s) return "the app time is outside 0..1e9 s";
  if (std::abs(v[2]) > 90.0 || std::abs(v[3]) > 180.0) return "latitude or longitude is outside the earth";
  if (v[6] <= 0.0) return "";   // no fix yet
  GnssFix fix{at(v[0]), {v[2], v[3]}, v[6], {}, {}};
  if (v[7] >= 0.0) fix.speed_mps = v[7];
  if (v[7] > 0.5 && v[5] >= 0.0 && v[5] <= 360.0) fix.course_azimuth_rad = v[5] * kDegree;
  fixes_.push_back(fix);
  return "";
}

// POSI;time;counter;lat;lon;floor;building
std::string LogReader::place(const std::vector<std::string_view>& fields) {
  std::array<double, 5> v{};
  if (!numbers(fields, 1, v)) return "time, counter, latitude, longitude and floor expected";
  if (v[0] < 0 || v[0] > kTimeMost_s) return "the time is outside 0..1e9 s";
  if (std::abs(v[2]) > 90.0 || std::abs(v[3]) > 180.0) return "latitude or longitude is outside the earth";
  if (std::abs(v[4]) > 200.0) return "the floor is outside -200..200";
  places_.push_back({v[0], {v[2], v[3]}, {static_cast<std::int32_t>(std::lround(v[4]))}});
  return "";
}

// Rows of one delivery share the application's time; an access point speaks once a list.
void LogReader::add_scans(std::vector<RecordedEvent>& events) const {
  std::map<double, std::map<Bssid, ScanReading>> scans;
  for (const WifiRow& row : wifi_) {
    ScanReading reading = row.reading;
    const double age_s = any_.known() && row.stamp.sensor_s > 0.0 ? row.stamp.app_s - any_.time_s(row.stamp) : 0.0;
    if (age_s > kAgeMost_s) continue;   // an honest row, but older than a reading may be
    reading.age = from_seconds(std::max(0.0, age_s));
    const auto [there, fresh] = scans[row.stamp.app_s].emplace(reading.bssid, reading);
    if (!fresh && reading.age < there->second.age) there->second = reading;
  }
  for (const auto& [time_s, readings] : scans) {
    RssScan scan{at(time_s), {}};
    for (const auto& [_, reading] : readings) scan.readings.push_back(reading);
    std::ranges::stable_sort(scan.readings, {}, &ScanReading::age);
    keep_youngest(scan, Limits::kReadingsPerScan);
    events.push_back(std::move(scan));
  }
}

ImportedRecording LogReader::finish(const std::string& path, const ImportSettings& settings) {
  ImportedRecording recording;
  recording.header = {"", "GetSensorData", "", {}};
  if (!places_.empty()) {
    const Georeference frame = settings.georeference.value_or(Georeference{places_.front().point, 0.0});
    if (!settings.georeference) {
      recording.complaints.push_back(path + ": no georeference was given: the first POSI is (0, 0), y is north");
    }
    for (const PlaceRow& row : places_) {
      recording.events.push_back(TruthMark{at(row.time_s), {frame.to_building(row.point), settings.floor.value_or(row.floor)}});
    }
  } else {
    recording.complaints.push_back(path + ": no POSI line, so no truth");
  }
  std::map<PhoneTime, MargSample> samples;
  for (const SensorRow& row : sensors_) {
    const PhoneTime time = at(clocks_[row.sensor].time_s(row.stamp));
    MargSample& sample = samples[time];
    sample.time = time;
    switch (row.sensor) {
      case 0: sample.acceleration_mps2 = row.value; break;
      case 1: sample.turn_rate_radps = row.value; break;
      case 2: sample.field_ut = row.value; break;
      default: sample.pressure_hpa = row.value.x; break;
    }
  }
  for (const auto& [_, sample] : samples) recording.events.push_back(sample);
  add_scans(recording.events);
  for (const GnssFix& fix : fixes_) recording.events.push_back(fix);
  std::stable_sort(recording.events.begin(), recording.events.end(),
                   [](const auto& a, const auto& b) { return time_of(a) < time_of(b); });
  return recording;
}

}  // namespace

Result<ImportedRecording> read_get_sensor_data(const std::string& path, const ImportSettings& settings) {
  auto file = TextFile::read(path);
  if (!file) return file.fault();
  LogReader reader;
  std::vector<std::string> complaints;
  std::vector<std::string_view> fields;
  std::size_t lines = 0;
  while (const auto line = file->next_line()) {
    if (line->empty() || line->starts_with('%')) continue;
    ++lines;
    split(*line, ';', fields);
    const std::string cause = reader.line(fields);
    if (!cause.empty()) complaints.push_back(path + ":" + std::to_string(file->line_number()) + ": " + cause);
  }
  if (lines == 0) return Fault{FaultCode::kMalformed, path, "holds no line of data"};
  if (complaints.size() * 20 > lines) {
    return Fault{FaultCode::kMalformed, path, std::to_string(complaints.size()) + " of " + std::to_string(lines) +
                                                  " lines do not parse, the first: " + complaints.front()};
  }
  ImportedRecording recording = reader.finish(path, settings);
  recording.complaints.insert(recording.complaints.begin(), complaints.begin(), complaints.end());
  return recording;
}

}  // namespace wayfuse
