#pragma once

#include <cmath>
#include <memory>
#include <string>

#include "server/pipeline/tracker.hpp"

namespace wayfuse::block {

// A square walk of 30 m a side around a block, radios at its corners and middles, surveyed both ways round.
inline constexpr double kSide_m = 30.0;
inline constexpr double kSpeedMps = 1.25;

inline BuildingPoint around(double walked_m) {
  const double along = std::fmod(std::fmod(walked_m, 4 * kSide_m) + 4 * kSide_m, 4 * kSide_m);
  const int side = static_cast<int>(along / kSide_m);
  const double rest = along - side * kSide_m;
  const BuildingPoint corners[] = {{0, 0}, {kSide_m, 0}, {kSide_m, kSide_m}, {0, kSide_m}};
  const double dx[] = {1, 0, -1, 0}, dy[] = {0, 1, 0, -1};
  return {corners[side].x_m + rest * dx[side], corners[side].y_m + rest * dy[side]};
}

inline RssScan scan_at(BuildingPoint p, int floor, double time_s) {
  RssScan scan{PhoneTime(from_seconds(time_s)), {}};
  for (int radio = 0; radio < 16; ++radio) {
    const BuildingPoint at = around(7.5 * radio);
    const double level = -38.0 - 22.0 * std::log10(1.0 + distance_m(p, at) / 2.0);
    if (level < -92.0) continue;
    scan.readings.push_back({Bssid{0x00'20'00'00'00'00u + static_cast<std::uint64_t>(floor * 64 + radio)}, level, Duration{0}, 2437, {}, {}});
  }
  return scan;
}

inline std::shared_ptr<const Site> block_site() {
  auto site = std::make_shared<Site>();
  site->building = BuildingId{1};
  for (int floor = 0; floor < 2; ++floor) {
    site->floors.push_back({FloorOrdinal{floor}, std::to_string(floor), {}, {}});
    for (int walk = 0; walk < 4; ++walk) {
      for (int i = 0; i <= 96; ++i) {
        const BuildingPoint p = around((walk % 2 ? -1.25 : 1.25) * i);
        site->survey.push_back(
            {{p, FloorOrdinal{floor}}, 0.0, "phone", "w" + std::to_string(floor * 4 + walk), {}, {scan_at(p, floor, i)}});
      }
    }
  }
  return site;
}

inline std::shared_ptr<const TrackerFactory> default_pipeline() {
  static const auto factory = *assemble(*preset("default"), block_site());
  return factory;
}

inline MotionReport step(double time_s, double heading_rad) {
  MotionReport motion;
  motion.time = PhoneTime(from_seconds(time_s));
  motion.interval = from_seconds(0.5);
  motion.heading = Heading::from_radians(heading_rad);
  motion.heading_sigma_rad = 0.1;
  motion.steps = 1;
  motion.step_length_m = kSpeedMps * 0.5;
  return motion;
}

inline MotionReport rest(double time_s) {
  MotionReport motion;
  motion.time = PhoneTime(from_seconds(time_s));
  motion.interval = from_seconds(0.5);
  motion.at_rest = true;
  return motion;
}

/// Walks from `begin_s` to `end_s` of a round at the compass error given; a scan every 2 s. Mean error of the last half.
inline double walk(Tracker& tracker, double begin_s, double end_s, double compass_error_rad, double louder_db = 0.0) {
  double sum = 0.0;
  int count = 0;
  for (double t = begin_s + 0.5; t <= end_s; t += 0.5) {
    const BuildingPoint a = around(kSpeedMps * (t - 0.5)), b = around(kSpeedMps * t);
    tracker.feed(step(t, std::atan2(b.y_m - a.y_m, b.x_m - a.x_m) + compass_error_rad));
    if (std::fmod(t, 2.0) == 0.0) {
      RssScan scan = scan_at(b, 1, t);
      for (ScanReading& reading : scan.readings) reading.rss_dbm += louder_db;
      tracker.feed(scan);
    }
    if (t < (begin_s + end_s) / 2) continue;
    const auto position = tracker.position(PhoneTime(from_seconds(t)));
    if (!position) return INFINITY;
    sum += distance_m(position->place.point, b);
    ++count;
  }
  return sum / count;
}

}  // namespace wayfuse::block
