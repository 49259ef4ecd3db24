#include "tests/benchmarks/match_world.hpp"

#include <algorithm>
#include <cmath>

#include "wayfuse/proto/random.hpp"

namespace wayfuse {

const MatchWorld& match_world(std::size_t points, std::size_t transmitters) {
  static std::vector<std::pair<std::size_t, std::unique_ptr<MatchWorld>>> made;
  for (const auto& [size, world] : made) {
    if (size == points) return *world;
  }
  auto world = std::make_unique<MatchWorld>();
  Random random(1);
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(points)));
  const double width_m = 2.0 * static_cast<double>(side);
  const double reach_m = width_m * std::sqrt(30.0 / (3.14159 * static_cast<double>(transmitters)));
  std::vector<BuildingPoint> places(transmitters);
  for (auto& place : places) place = {width_m * random.uniform(), width_m * random.uniform()};
  const auto scan_at = [&](BuildingPoint at) {
    RssScan scan;
    for (std::size_t i = 0; i < transmitters; ++i) {
      const double d_m = distance_m(at, places[i]);
      if (d_m < reach_m) scan.readings.push_back({Bssid{i + 1}, std::round(-40.0 - 50.0 * d_m / reach_m + 3.0 * random.normal()), {}, 0, {}, {}});
    }
    return scan;
  };
  std::vector<ReferencePoint> survey;
  for (std::size_t i = 0; i < side * side; ++i) {
    ReferencePoint point;
    point.place.point = {2.0 * static_cast<double>(i % side), 2.0 * static_cast<double>(i / side)};
    point.scans = {scan_at(point.place.point)};
    survey.push_back(std::move(point));
  }
  world->map = RadioMap::build(survey);
  const std::size_t columns = world->map->transmitters().size();
  world->dense.assign(world->map->points().size() * columns, -100.0f);
  for (std::size_t j = 0; j < world->map->points().size(); ++j) {
    for (const MapLevel& level : world->map->levels(world->map->points()[j])) world->dense[j * columns + level.transmitter] = level.mean_dbm;
  }
  for (int i = 0; i < 64; ++i) world->scans.push_back(scan_at({width_m * random.uniform(), width_m * random.uniform()}));
  return *made.emplace_back(points, std::move(world)).second;
}

void dense_row(const MatchWorld& world, const RssScan& scan, KnownScan& known, std::vector<float>& row) {
  world.map->know(scan, known);
  row.assign(world.map->transmitters().size(), -100.0f);
  for (const KnownScan::Level& level : known.levels) row[level.transmitter] = level.rss_dbm;
}

}  // namespace wayfuse
