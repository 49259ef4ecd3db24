#include "sdk/src/recording/import/recorded_walk.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "sdk/src/recording/import/text_line.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse {
namespace {

constexpr std::int64_t kReadingAgeMost_ms = 600'000;  // the contract's bound for ScanReading::age

PhoneTime phone_time(std::int64_t milliseconds) {
  return PhoneTime(std::chrono::milliseconds(milliseconds));
}

// Collects the lines of one file.
class WalkReader {
 public:
  WalkReader(RecordedWalk& walk, BuildingPoint floor_origin) : walk_(walk), origin_(floor_origin) {}

  void header(std::string_view line);
  /// Empty = taken (or a type we do not use); otherwise why not.
  std::string line(const std::vector<std::string_view>& fields);
  void finish();

 private:
  std::string wifi(std::int64_t time_ms, const std::vector<std::string_view>& fields);
  std::string way_point(std::int64_t time_ms, const std::vector<std::string_view>& fields);
  std::string sensor(std::int64_t time_ms, const std::vector<std::string_view>& fields,
                     std::optional<Vector3> MargSample::*which);
  std::string attitude(std::int64_t time_ms, const std::vector<std::string_view>& fields);

  RecordedWalk& walk_;
  BuildingPoint origin_;
  std::map<std::int64_t, MargSample> motion_;
  std::map<std::int64_t, std::map<Bssid, ScanReading>> scans_;  // a transmitter speaks once a list: its newest row
};

void WalkReader::header(std::string_view line) {
  for (const auto& [key, target] : {std::pair{std::string_view("Model:"), &walk_.device_model},
                                    std::pair{std::string_view("FloorName:"), &walk_.floor_label}}) {
    const std::size_t at = line.find(key);
    if (at == std::string_view::npos) continue;
    const std::string_view rest = line.substr(at + key.size());
    *target = std::string(rest.substr(0, rest.find('\t')));
  }
}

std::string WalkReader::line(const std::vector<std::string_view>& fields) {
  if (fields.size() < 2) return "neither a header nor `time TYPE values`";
  const auto time_ms = whole_number(fields[0]);
  if (!time_ms || *time_ms < 0 || *time_ms > 9'999'999'999'999) return "the time is not milliseconds since 1970";
  const std::string_view type = fields[1];
  if (type == "TYPE_ACCELEROMETER") return sensor(*time_ms, fields, &MargSample::acceleration_mps2);
  if (type == "TYPE_GYROSCOPE") return sensor(*time_ms, fields, &MargSample::turn_rate_radps);
  if (type == "TYPE_MAGNETIC_FIELD") return sensor(*time_ms, fields, &MargSample::field_ut);
  if (type == "TYPE_ROTATION_VECTOR") return attitude(*time_ms, fields);
  if (type == "TYPE_WIFI") return wifi(*time_ms, fields);
  if (type == "TYPE_WAYPOINT") return way_point(*time_ms, fields);
  return type.starts_with("TYPE_") ? "" : "unknown kind of line";
}

std::string WalkReader::sensor(std::int64_t time_ms, const std::vector<std::string_view>& fields,
                               std::optional<Vector3> MargSample::*which) {
  double value[3];
  if (!numbers(fields, 2, value)) return "three sensor axes expected";
  MargSample& sample = motion_[time_ms];
  sample.*which = Vector3{value[0], value[1], value[2]};
  return "";
}

std::string WalkReader::attitude(std::int64_t time_ms, const std::vector<std::string_view>& fields) {
  double v[3];
  if (!numbers(fields, 2, v)) return "three components of a rotation vector expected";
  const double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  if (square > 1.01) return "the rotation vector is longer than 1";
  walk_.attitudes.push_back({phone_time(time_ms), {std::sqrt(std::max(0.0, 1.0 - square)), v[0], v[1], v[2]}});
  return "";
}

// time, TYPE_WIFI, ssid, bssid, dBm, MHz, last seen. The network's name may hold anything, tabs too: count from the end.
std::string WalkReader::wifi(std::int64_t time_ms, const std::vector<std::string_view>& fields) {
  if (fields.size() < 7) return "ssid, bssid, rssi, frequency and last-seen time expected";
  const std::size_t last = fields.size() - 1;
  const auto bssid = parse_bssid(fields[last - 3]);
  if (!bssid) return "not a BSSID: " + shown(fields[last - 3]);
  const auto rss = number(fields[last - 2]);
  if (!rss || *rss < -120.0 || *rss > 0.0) return "rssi " + shown(fields[last - 2]) + " is outside -120..0 dBm";
  const auto frequency = whole_number(fields[last - 1]);
  if (!frequency || *frequency < 0 || *frequency > 65535) return "not a frequency: " + shown(fields[last - 1]);
  const auto last_seen_ms = whole_number(fields[last]);
  if (!last_seen_ms || *last_seen_ms < 0 || *last_seen_ms > 9'999'999'999'999) return "not a last-seen time: " + shown(fields[last]);
  const std::int64_t age_ms = std::max<std::int64_t>(0, time_ms - *last_seen_ms);
  auto& readings = scans_[time_ms];
  if (age_ms > kReadingAgeMost_ms) return "";  // an honest row, but older than a reading may be
  ScanReading reading;
  reading.bssid = *bssid;
  reading.rss_dbm = *rss;
  reading.age = std::chrono::milliseconds(age_ms);
  reading.frequency_mhz = static_cast<std::uint16_t>(*frequency);
  const auto [at, fresh] = readings.emplace(*bssid, reading);
  if (!fresh && reading.age < at->second.age) at->second = reading;
  return "";
}

std::string WalkReader::way_point(std::int64_t time_ms, const std::vector<std::string_view>& fields) {
  double value[2];
  if (!numbers(fields, 2, value)) return "a way point's x and y in metres expected";
  walk_.way_points.push_back({phone_time(time_ms), {origin_.x_m + value[0], origin_.y_m + value[1]}});
  return "";
}

void WalkReader::finish() {
  walk_.motion.reserve(motion_.size());
  for (auto& [time_ms, sample] : motion_) {
    sample.time = phone_time(time_ms);
    walk_.motion.push_back(sample);
  }
  for (const auto& [time_ms, readings] : scans_) {
    RssScan scan{phone_time(time_ms), {}};
    for (const auto& [_, reading] : readings) scan.readings.push_back(reading);
    keep_youngest(scan, Limits::kReadingsPerScan);
    walk_.scans.push_back(std::move(scan));
  }
  const auto by_time = [](const auto& a, const auto& b) { return a.time < b.time; };
  std::stable_sort(walk_.way_points.begin(), walk_.way_points.end(), by_time);
  std::stable_sort(walk_.attitudes.begin(), walk_.attitudes.end(), by_time);
}

}  // namespace

std::optional<BuildingPoint> RecordedWalk::truth_at(PhoneTime time) const {
  if (way_points.empty() || time < way_points.front().time || time > way_points.back().time) return std::nullopt;
  const auto after = std::lower_bound(way_points.begin(), way_points.end(), time,
                                      [](const TruePoint& point, PhoneTime t) { return point.time < t; });
  if (after == way_points.begin() || after->time == time) return after->point;
  const auto before = after - 1;
  const double share = seconds(time - before->time) / seconds(after->time - before->time);
  return BuildingPoint{before->point.x_m + share * (after->point.x_m - before->point.x_m),
                       before->point.y_m + share * (after->point.y_m - before->point.y_m)};
}

double RecordedWalk::duration_s() const {
  return way_points.empty() ? 0.0 : seconds(way_points.back().time - way_points.front().time);
}

Result<RecordedWalk> read_walk(const std::string& path, BuildingPoint floor_origin, bool needs_way_points) {
  auto file = TextFile::read(path);
  if (!file) return file.fault();
  RecordedWalk walk;
  walk.id = std::filesystem::path(path).stem().string();
  WalkReader reader(walk, floor_origin);
  std::vector<std::string_view> fields;
  std::size_t lines = 0;
  while (const auto line = file->next_line()) {
    if (line->empty()) continue;
    if (line->starts_with('#')) {
      reader.header(*line);
      continue;
    }
    ++lines;
    split(*line, '\t', fields);
    const std::string cause = reader.line(fields);
    if (!cause.empty()) walk.complaints.push_back(file->path() + ":" + std::to_string(file->line_number()) + ": " + cause);
  }
  reader.finish();
  if (walk.complaints.size() * 20 > lines) {
    return Fault{FaultCode::kMalformed, path,
                 std::to_string(walk.complaints.size()) + " of " + std::to_string(lines) +
                     " lines do not parse, the first: " + walk.complaints.front()};
  }
  if (needs_way_points && walk.way_points.empty())
    return Fault{FaultCode::kMalformed, path, "holds no TYPE_WAYPOINT line: nothing to survey or score"};
  return walk;
}

}  // namespace wayfuse
