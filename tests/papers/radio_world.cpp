#include "tests/papers/radio_world.hpp"

#include <cmath>
#include <numbers>

namespace wayfuse::papers {

RadioWorld::RadioWorld(const RadioSettings& settings, std::vector<BuildingPoint> transmitters, std::vector<Wall> walls, Random& random)
    : settings_(settings), transmitters_(std::move(transmitters)), walls_(std::move(walls)), shadows_(transmitters_.size()),
      blocked_db_(transmitters_.size(), 0.0) {
  for (auto& waves : shadows_) {
    for (Wave& wave : waves) {
      wave = {random.normal() / settings.shadow_length_m, random.normal() / settings.shadow_length_m,
              2.0 * std::numbers::pi * random.uniform()};
    }
  }
}

double RadioWorld::shadow_db(std::size_t transmitter, BuildingPoint at) const {
  double sum = 0.0;
  for (const Wave& wave : shadows_[transmitter]) sum += std::cos(wave.kx * at.x_m + wave.ky * at.y_m + wave.phase);
  return settings_.shadow_db * sum * std::sqrt(2.0 / kWaves);
}

bool crosses(const Wall& wall, BuildingPoint a, BuildingPoint b) {
  const auto side = [](BuildingPoint p, BuildingPoint q, BuildingPoint r) {
    return (q.x_m - p.x_m) * (r.y_m - p.y_m) - (q.y_m - p.y_m) * (r.x_m - p.x_m);
  };
  return side(wall.from, wall.to, a) * side(wall.from, wall.to, b) < 0.0 && side(a, b, wall.from) * side(a, b, wall.to) < 0.0;
}

double RadioWorld::mean_dbm(std::size_t transmitter, BuildingPoint at) const {
  const BuildingPoint from = transmitters_[transmitter];
  const double far_m = std::max(1.0, std::sqrt(std::pow(at.x_m - from.x_m, 2) + std::pow(at.y_m - from.y_m, 2)));
  double milliwatts = std::pow(10.0, settings_.level_at_1m_dbm / 10.0) * std::pow(far_m, -settings_.exponent);
  milliwatts *= std::pow(10.0, -blocked_db_[transmitter] / 10.0);
  for (const Wall& wall : walls_) {
    if (crosses(wall, from, at)) milliwatts *= std::pow(10.0, -settings_.wall_db / 10.0);
  }
  return 10.0 * std::log10(milliwatts) + (settings_.shadow_db > 0.0 ? shadow_db(transmitter, at) : 0.0);
}

RssScan RadioWorld::scan(BuildingPoint at, PhoneTime time, Random& random) const {
  RssScan scan{time, {}};
  for (std::size_t i = 0; i < size(); ++i) {
    double rss_dbm = mean_dbm(i, at) + settings_.fade_db * random.normal();
    if (settings_.rounding_db > 0.0) rss_dbm = settings_.rounding_db * std::round(rss_dbm / settings_.rounding_db);
    if (rss_dbm < settings_.deaf_below_dbm) continue;
    scan.readings.push_back({bssid(i), rss_dbm, Duration{0}, 2412, {}, {}});
  }
  return scan;
}

std::vector<ReferencePoint> RadioWorld::survey(const std::vector<BuildingPoint>& points, int scans_each, Random& random) const {
  std::vector<ReferencePoint> made;
  for (const BuildingPoint at : points) {
    ReferencePoint point;
    point.place = {at, FloorOrdinal{0}};
    for (int i = 0; i < scans_each; ++i) point.scans.push_back(scan(at, PhoneTime{}, random));
    made.push_back(std::move(point));
  }
  return made;
}

std::vector<BuildingPoint> grid(BuildingPoint from, BuildingPoint to, double spacing_m) {
  std::vector<BuildingPoint> points;
  const int columns = static_cast<int>(std::lround((to.x_m - from.x_m) / spacing_m));
  const int rows = static_cast<int>(std::lround((to.y_m - from.y_m) / spacing_m));
  for (int i = 0; i <= columns; ++i) {
    for (int j = 0; j <= rows; ++j) points.push_back({from.x_m + i * spacing_m, from.y_m + j * spacing_m});
  }
  return points;
}

}  // namespace wayfuse::papers
