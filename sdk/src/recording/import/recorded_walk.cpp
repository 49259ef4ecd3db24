#include "sdk/src/recording/import/recorded_walk.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "sdk/src/recording/import/text_line.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse {
namespace {

constexpr std::int64_t kReadingAgeMost_ms = 600'000;  // the contract's bound for ScanReading::age

constexpr std::int64_t kBreakMost_ms = 3'600'000;    // between two lines of one walk
constexpr double kFarthest_m = 10'000.0;             // a way point from the frame's origin

PhoneTime phone_time(std::int64_t milliseconds) {
  return PhoneTime(std::chrono::milliseconds(milliseconds));
}

struct NumberedLine {
  std::string_view text;
  int number;
};

std::optional<std::int64_t> time_of(std::string_view line) { return whole_number(line.substr(0, line.find('\t'))); }

// From the first to the last time around the median without a break: what lies beyond was stamped by a wrong clock.
std::pair<std::int64_t, std::int64_t> span_of(const std::vector<NumberedLine>& lines) {
  std::vector<std::int64_t> times;
  for (const NumberedLine& line : lines) {
    if (const auto time_ms = time_of(line.text)) times.push_back(*time_ms);
  }
  if (times.empty()) return {0, 0};
  std::sort(times.begin(), times.end());
  std::size_t first = times.size() / 2, last = first;
  while (first > 0 && times[first] - times[first - 1] < kBreakMost_ms) --first;
  while (last + 1 < times.size() && times[last + 1] - times[last] < kBreakMost_ms) ++last;
  return {times[first], times[last]};
}

// What the protocol takes for a name: UTF-8 without control characters, not too long.
bool is_name(std::string_view text) {
  std::size_t following = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f || (following > 0) != ((byte & 0xC0) == 0x80)) return false;
    if (following > 0)
      --following;
    else
      following = byte < 0x80 ? 0 : byte < 0xE0 ? 1 : byte < 0xF0 ? 2 : 3;
  }
  return following == 0 && text.size() <= Limits::kStringBytes;
}

// Collects the lines of one file.
class WalkReader {
 public:
  WalkReader(RecordedWalk& walk, BuildingPoint floor_origin, std::string path)
      : walk_(walk), origin_(floor_origin), path_(std::move(path)) {}

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
  void note(const std::string& what) { walk_.notes.push_back(path_ + ": " + what); }
  void judge_ages();

  using Lists = std::map<std::int64_t, std::map<Bssid, ScanReading>>;  // a transmitter speaks once a list: its newest row

  RecordedWalk& walk_;
  BuildingPoint origin_;
  std::string path_;
  std::map<std::int64_t, MargSample> motion_;
  Lists scans_;
  Lists aged_;  // rows older than a reading may be, as if heard when listed
  std::size_t rows_ = 0, rows_undated_ = 0, rows_aged_ = 0;
};

void WalkReader::header(std::string_view line) {
  for (const auto& [key, target] : {std::pair{std::string_view("Model:"), &walk_.device_model},
                                    std::pair{std::string_view("FloorName:"), &walk_.floor_label}}) {
    const std::size_t at = line.find(key);
    if (at == std::string_view::npos) continue;
    const std::string_view rest = line.substr(at + key.size());
    *target = std::string(rest.substr(0, rest.find('\t')));
  }
  if (is_name(walk_.device_model)) return;
  note("Model: " + shown(walk_.device_model) + ": no name the protocol takes, left out");
  walk_.device_model.clear();
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

// time, TYPE_WIFI, ssid, bssid, dBm, MHz, last seen. The network's name may hold anything, tabs too: count from the end. Some
// recorders leave the last one out, some end a row with a tab.
std::string WalkReader::wifi(std::int64_t time_ms, const std::vector<std::string_view>& fields) {
  std::size_t count = fields.size();
  while (count > 6 && fields[count - 1].empty()) --count;
  const bool dated = count >= 7 && (parse_bssid(fields[count - 4]) || !parse_bssid(fields[count - 3]));
  if (count < 6) return "ssid, bssid, rssi, frequency and last-seen time expected";
  const std::size_t mhz = count - (dated ? 2 : 1);
  const auto bssid = parse_bssid(fields[mhz - 2]);
  if (!bssid) return "not a BSSID: " + shown(fields[mhz - 2]);
  const auto rss = number(fields[mhz - 1]);
  if (!rss || *rss < -120.0 || *rss > 0.0) return "rssi " + shown(fields[mhz - 1]) + " is outside -120..0 dBm";
  const auto frequency = whole_number(fields[mhz]);
  if (!frequency || *frequency < 0 || *frequency > 65535) return "not a frequency: " + shown(fields[mhz]);
  const auto last_seen_ms = dated ? whole_number(fields[mhz + 1]) : time_ms;
  if (!last_seen_ms || *last_seen_ms < 0 || *last_seen_ms > 9'999'999'999'999) return "not a last-seen time: " + shown(fields[mhz + 1]);
  const std::int64_t age_ms = std::max<std::int64_t>(0, time_ms - *last_seen_ms);
  const bool aged = age_ms > kReadingAgeMost_ms;  // an honest row, but older than a reading may be
  rows_++, rows_undated_ += !dated, rows_aged_ += aged;
  ScanReading reading;
  reading.bssid = *bssid;
  reading.rss_dbm = *rss;
  reading.age = std::chrono::milliseconds(aged ? 0 : age_ms);
  reading.frequency_mhz = static_cast<std::uint16_t>(*frequency);
  auto& readings = scans_[time_ms];
  const auto [at, fresh] = (aged ? aged_[time_ms] : readings).emplace(*bssid, reading);
  if (!fresh && reading.age < at->second.age) at->second = reading;
  return "";
}

std::string WalkReader::way_point(std::int64_t time_ms, const std::vector<std::string_view>& fields) {
  double value[2];
  if (!numbers(fields, 2, value)) return "a way point's x and y in metres expected";
  if (std::hypot(value[0], value[1]) > kFarthest_m) return "the way point is farther than 10 km from the frame's origin";
  walk_.way_points.push_back({phone_time(time_ms), {origin_.x_m + value[0], origin_.y_m + value[1]}});
  return "";
}

void WalkReader::judge_ages() {
  const auto of_rows = [&](std::size_t some) { return std::to_string(some) + " of " + std::to_string(rows_) + " WIFI rows "; };
  if (rows_undated_ > 0) note(of_rows(rows_undated_) + "tell no last-seen time: taken as heard when they were listed");
  if (rows_aged_ > 0 && rows_aged_ == rows_) {
    note("no WIFI row was last seen within 600 s of its own time, as by another clock: all taken as heard when they were listed");
    scans_ = std::move(aged_);
  } else if (2 * rows_aged_ > rows_) {
    note(of_rows(rows_aged_) + "were last seen more than 600 s before they were listed, and are left out");
  }
}

void WalkReader::finish() {
  judge_ages();
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
  WalkReader reader(walk, floor_origin, path);
  std::vector<NumberedLine> lines;
  while (const auto line = file->next_line()) {
    if (line->starts_with('#'))
      reader.header(*line);
    else if (!line->empty())
      lines.push_back({*line, file->line_number()});
  }
  const auto [first_ms, last_ms] = span_of(lines);
  std::vector<std::string_view> fields;
  for (const NumberedLine& line : lines) {
    split(line.text, '\t', fields);
    const auto time_ms = time_of(line.text);
    const bool stray = fields.size() >= 2 && time_ms && (*time_ms < first_ms || *time_ms > last_ms);
    const std::string cause = stray ? "its time is an hour or more apart from the rest of the walk" : reader.line(fields);
    if (!cause.empty()) walk.complaints.push_back(path + ":" + std::to_string(line.number) + ": " + cause);
  }
  reader.finish();
  if (walk.complaints.size() * 20 > lines.size()) {
    return Fault{FaultCode::kMalformed, path,
                 std::to_string(walk.complaints.size()) + " of " + std::to_string(lines.size()) +
                     " lines do not parse, the first: " + walk.complaints.front()};
  }
  if (needs_way_points && walk.way_points.empty())
    return Fault{FaultCode::kMalformed, path, "holds no TYPE_WAYPOINT line: nothing to survey or score"};
  return walk;
}

}  // namespace wayfuse
