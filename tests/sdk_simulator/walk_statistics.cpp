#include "tests/sdk_simulator/walk_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "wayfuse/sdk/motion_tracker.hpp"

namespace wayfuse {
namespace {

constexpr Duration kSameReading = std::chrono::milliseconds(50);   // nothing is heard twice in less
constexpr double kLegLeast_m = 8.0;
constexpr double kDegree = std::numbers::pi / 180.0;

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Rows {
  std::vector<double> ages_s, rss_dbm, jumps_db, intervals_s, repeated, same_stamp;
};

void collect_scans(const std::vector<RecordedEvent>& walk, Rows& rows) {
  struct Known {
    PhoneTime at;
    double rss_dbm;
  };
  std::map<Bssid, Known> known;
  const RssScan* before = nullptr;
  for (const RecordedEvent& event : walk) {
    const auto* scan = std::get_if<RssScan>(&event);
    if (!scan || scan->readings.empty()) continue;
    std::size_t repeats = 0, same_stamps = 0;
    for (const ScanReading& reading : scan->readings) {
      const PhoneTime at = scan->time - reading.age;
      rows.ages_s.push_back(seconds(reading.age));
      rows.rss_dbm.push_back(reading.rss_dbm);
      const auto [there, fresh] = known.emplace(reading.bssid, Known{at, reading.rss_dbm});
      if (fresh) continue;
      same_stamps += there->second.at == at;
      if (at <= there->second.at + kSameReading) {
        ++repeats;
        continue;
      }
      rows.jumps_db.push_back(std::abs(reading.rss_dbm - there->second.rss_dbm));
      there->second = {at, reading.rss_dbm};
    }
    if (before) {
      rows.intervals_s.push_back(seconds(scan->time - before->time));
      rows.repeated.push_back(static_cast<double>(repeats) / static_cast<double>(scan->readings.size()));
      rows.same_stamp.push_back(static_cast<double>(same_stamps) / static_cast<double>(scan->readings.size()));
    }
    before = scan;
  }
}

/// Directions of the steps between marks against the marks' own, one walk.
void collect_motion(const std::vector<RecordedEvent>& walk, std::vector<double>& cadences_hz, std::vector<double>& off_deg) {
  MotionTracker tracker = std::move(MotionTracker::create({})).value();
  std::optional<TruthMark> from;
  double east_m = 0, north_m = 0;
  std::vector<double> turned_rad;
  for (const RecordedEvent& event : walk) {
    if (const auto* sample = std::get_if<MargSample>(&event)) {
      const auto report = tracker.feed(*sample);
      if (!report) continue;
      east_m += report->distance_m() * report->heading.cos();
      north_m += report->distance_m() * report->heading.sin();
      if (tracker.walk().walking && tracker.walk().cadence_hz > 0) cadences_hz.push_back(tracker.walk().cadence_hz);
    } else if (const auto* mark = std::get_if<TruthMark>(&event)) {
      if (from && from->place.floor == mark->place.floor) {
        const double dx = mark->place.point.x_m - from->place.point.x_m, dy = mark->place.point.y_m - from->place.point.y_m;
        if (std::hypot(dx, dy) < kLegLeast_m) continue;
        if (std::hypot(east_m, north_m) > 0.5 * kLegLeast_m) {
          turned_rad.push_back(Heading::from_vector(east_m, north_m).minus(Heading::from_vector(dx, dy)));
        }
      }
      from = *mark;
      east_m = north_m = 0;
    }
  }
  if (turned_rad.size() < 2) return;
  double c = 0, s = 0;   // the walk's own offset: the mean direction of its errors
  for (const double turned : turned_rad) c += std::cos(turned), s += std::sin(turned);
  for (const double turned : turned_rad) off_deg.push_back(std::abs(wrap_angle_rad(turned - std::atan2(s, c))) / kDegree);
}

}  // namespace

WalkStatistics statistics_of(const std::vector<std::vector<RecordedEvent>>& walks) {
  Rows rows;
  std::vector<double> cadences_hz, off_deg;
  WalkStatistics statistics;
  for (const auto& walk : walks) {
    collect_scans(walk, rows);
    collect_motion(walk, cadences_hz, off_deg);
  }
  statistics.walks = walks.size();
  statistics.scans = rows.intervals_s.size() + walks.size();
  statistics.age_median_s = quantile(rows.ages_s, 0.5);
  statistics.age_p90_s = quantile(rows.ages_s, 0.9);
  for (const double share : rows.repeated) statistics.repeated_share += share / static_cast<double>(rows.repeated.size());
  for (const double share : rows.same_stamp) statistics.same_stamp_share += share / static_cast<double>(rows.same_stamp.size());
  statistics.interval_median_s = quantile(rows.intervals_s, 0.5);
  statistics.rss_p5_dbm = quantile(rows.rss_dbm, 0.05);
  statistics.rss_median_dbm = quantile(rows.rss_dbm, 0.5);
  statistics.rss_p95_dbm = quantile(rows.rss_dbm, 0.95);
  statistics.jump_median_db = quantile(rows.jumps_db, 0.5);
  statistics.jump_p90_db = quantile(rows.jumps_db, 0.9);
  statistics.cadence_median_hz = quantile(cadences_hz, 0.5);
  statistics.direction_median_deg = quantile(off_deg, 0.5);
  statistics.legs = off_deg.size();
  return statistics;
}

std::string to_string(const WalkStatistics& s) {
  std::ostringstream text;
  text << s.walks << " walks, " << s.scans << " lists, one every " << s.interval_median_s << " s\n"
       << "age of a row, median and p90: " << s.age_median_s << " s, " << s.age_p90_s << " s\n"
       << "rows told before: " << 100 * s.repeated_share << " %, with the same stamp " << 100 * s.same_stamp_share << " %\n"
       << "rss p5, median, p95: " << s.rss_p5_dbm << ", " << s.rss_median_dbm << ", " << s.rss_p95_dbm << " dBm\n"
       << "jump between readings, median and p90: " << s.jump_median_db << ", " << s.jump_p90_db << " dB\n"
       << "cadence: " << s.cadence_median_hz << " Hz\n"
       << "direction of " << s.legs << " stretches, off by a median of " << s.direction_median_deg << " degrees\n";
  return text.str();
}

}  // namespace wayfuse
