#include "server/sessions/explanation.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace wayfuse {
namespace {

constexpr std::size_t kPointsMost = 8;
constexpr double kAround_m = 12.0;  // levels change by a few decibels within it; surveys are seldom sparser

struct Near {
  double distance_m;
  const ReferencePoint* point;
};

std::vector<Near> surveyed_near(const std::vector<ReferencePoint>& survey, const Place& place) {
  std::vector<Near> near;
  for (const ReferencePoint& point : survey) {
    const double away_m = distance_m(point.place.point, place.point);
    if (point.place.floor == place.floor && away_m <= kAround_m) near.push_back({away_m, &point});
  }
  std::ranges::stable_sort(near, {}, &Near::distance_m);
  if (near.size() > kPointsMost) near.resize(kPointsMost);
  return near;
}

struct Level {
  double sum_dbm = 0.0;
  int scans = 0;
};

std::map<Bssid, Level> levels_of(const std::vector<Near>& near) {
  std::map<Bssid, Level> levels;
  for (const Near& each : near) {
    for (const RssScan& scan : each.point->scans) {
      for (const ScanReading& reading : scan.readings) {
        Level& level = levels[reading.bssid];
        level.sum_dbm += reading.rss_dbm;
        ++level.scans;
      }
    }
  }
  return levels;
}

bool more_telling(const ReadingExplained& a, const ReadingExplained& b) {
  if (a.rejected.empty() != b.rejected.empty()) return a.rejected.empty();
  const double residual_a = a.expected_dbm ? std::abs(*a.residual_db()) : -1.0;
  const double residual_b = b.expected_dbm ? std::abs(*b.residual_db()) : -1.0;
  return residual_a != residual_b ? residual_a > residual_b : a.bssid < b.bssid;
}

}  // namespace

PositionGrounds grounds_of(const Tracker& tracker, FusedPosition position, RssScan newest, std::size_t most_particles) {
  PositionGrounds grounds{std::move(position), std::move(newest), {}, {}, most_particles > 0 ? tracker.cloud(most_particles) : std::vector<WeightedPlace>()};
  grounds.doubts = tracker.doubts(grounds.position.valid_at);
  for (const ScanReading& reading : grounds.scan.readings) grounds.left_out.push_back(tracker.left_out(reading));
  return grounds;
}

Explanation explain(const Building& building, PositionGrounds grounds) {
  Explanation explanation;
  const std::vector<Near> near = surveyed_near(building.site()->survey, grounds.position.place);
  const std::map<Bssid, Level> levels = levels_of(near);
  explanation.surveyed_points = static_cast<int>(near.size());
  for (std::size_t i = 0; i < grounds.scan.readings.size(); ++i) {
    const ScanReading& reading = grounds.scan.readings[i];
    ReadingExplained explained{reading.bssid, reading.rss_dbm, reading.age, std::move(grounds.left_out[i]), {}, 0};
    if (!std::ranges::binary_search(building.transmitters(), reading.bssid)) explained.rejected = "not on the map";
    if (const auto found = levels.find(reading.bssid); found != levels.end()) {
      explained.expected_dbm = found->second.sum_dbm / found->second.scans;
      explained.surveyed_scans = found->second.scans;
    }
    explanation.readings.push_back(std::move(explained));
  }
  std::ranges::sort(explanation.readings, more_telling);
  explanation.position = std::move(grounds.position);
  explanation.doubts = std::move(grounds.doubts);
  for (const WeightedPlace& place : grounds.particles) explanation.particles.push_back({place.point, place.weight});
  return explanation;
}

}  // namespace wayfuse
