#include "server/locating/path_loss.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "server/locating/locator.hpp"

namespace wayfuse {
namespace {

constexpr double kLeastDistanceM = 1.0;   // the law's own reference distance
constexpr double kMostDistanceM = 1000.0;
constexpr std::size_t kMostPoints = 200;  // the loudest place a transmitter; more only cost time
constexpr double kVoteDb = 6.0;
constexpr int kGrid = 24;                 // cells a side of the first search

struct Sample {
  BuildingPoint at;
  double dbm;
};

struct Candidate {
  double squared_db = std::numeric_limits<double>::infinity();
  BuildingPoint at;
  double level_dbm = 0.0;
  double exponent = 2.0;
};

double log_distance(BuildingPoint a, BuildingPoint b) { return std::log10(std::max(distance_m(a, b), kLeastDistanceM)); }

// For a place the law is a straight line in log distance: level and exponent in closed form.
Candidate judge(const std::vector<Sample>& samples, BuildingPoint at) {
  const auto n = static_cast<double>(samples.size());
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
  for (const Sample& sample : samples) {
    const double x = log_distance(sample.at, at);
    sx += x;
    sy += sample.dbm;
    sxx += x * x;
    sxy += x * sample.dbm;
    syy += sample.dbm * sample.dbm;
  }
  const double spread = sxx - sx * sx / n;
  const double slope = spread > 1e-9 ? (sxy - sx * sy / n) / spread : -20.0;
  Candidate candidate;
  candidate.at = at;
  candidate.exponent = std::clamp(-slope / 10.0, kLeastExponent, kMostExponent);
  const double b = -10.0 * candidate.exponent;
  candidate.level_dbm = (sy - b * sx) / n;
  const double a = candidate.level_dbm;
  candidate.squared_db = std::max(0.0, syy - 2.0 * a * sy - 2.0 * b * sxy + n * a * a + 2.0 * a * b * sx + b * b * sxx);
  return candidate;
}

Candidate search(const std::vector<Sample>& samples) {
  double least_x = INFINITY, most_x = -INFINITY, least_y = INFINITY, most_y = -INFINITY;
  for (const Sample& sample : samples) {
    least_x = std::min(least_x, sample.at.x_m);
    most_x = std::max(most_x, sample.at.x_m);
    least_y = std::min(least_y, sample.at.y_m);
    most_y = std::max(most_y, sample.at.y_m);
  }
  const double margin = 5.0 + 0.25 * std::max(most_x - least_x, most_y - least_y);  // it may hang beside the surveyed ground
  const double step_x = (most_x - least_x + 2 * margin) / kGrid, step_y = (most_y - least_y + 2 * margin) / kGrid;
  Candidate best;
  for (int i = 0; i <= kGrid; ++i) {
    for (int j = 0; j <= kGrid; ++j) {
      const Candidate each = judge(samples, {least_x - margin + i * step_x, least_y - margin + j * step_y});
      if (each.squared_db < best.squared_db) best = each;
    }
  }
  for (double step = std::max(step_x, step_y); step > 1e-3;) {
    const Candidate centre = best;
    for (const auto& [dx, dy] : {std::pair{1., 0.}, {-1., 0.}, {0., 1.}, {0., -1.}, {.7, .7}, {-.7, .7}, {.7, -.7}, {-.7, -.7}}) {
      const Candidate each = judge(samples, {centre.at.x_m + step * dx, centre.at.y_m + step * dy});
      if (each.squared_db < best.squared_db) best = each;
    }
    if (best.squared_db >= centre.squared_db) step *= 0.5;
  }
  return best;
}

std::optional<PathLoss> fit(std::map<FloorOrdinal, std::vector<Sample>>& by_floor) {
  const auto loudest_place = [](const auto& entry) { return std::ranges::max(entry.second, {}, &Sample::dbm).dbm; };
  auto& [floor, samples] = *std::ranges::max_element(by_floor, {}, loudest_place);
  if (samples.size() < 4) return std::nullopt;
  if (samples.size() > kMostPoints) {
    std::ranges::partial_sort(samples, samples.begin() + kMostPoints, std::ranges::greater{}, &Sample::dbm);
    samples.resize(kMostPoints);
  }
  const Candidate best = search(samples);
  if (!std::isfinite(best.squared_db)) return std::nullopt;
  const auto n = static_cast<double>(samples.size());
  const double sigma_db = std::max(0.1, std::sqrt(best.squared_db / std::max(1.0, n - 4.0)));  // four numbers were fitted
  return PathLoss{{best.at, floor}, best.level_dbm, best.exponent, sigma_db, static_cast<int>(samples.size())};
}

}  // namespace

double PathLoss::level_dbm(double distance_m) const {
  return at_1m_dbm - 10.0 * exponent * std::log10(std::max(distance_m, kLeastDistanceM));
}

double PathLoss::distance_m(double rss_dbm, double with_exponent) const {
  return std::min(std::pow(10.0, (at_1m_dbm - rss_dbm) / (10.0 * with_exponent)), kMostDistanceM);
}

void vote_for_floors(std::span<const KnownScan::Level> levels, std::span<const std::optional<PathLoss>> laws, std::vector<FloorProbability>& votes) {
  votes.clear();
  const float loudest = std::ranges::max(levels, {}, &KnownScan::Level::rss_dbm).rss_dbm;
  double sum = 0.0;
  for (const auto& level : levels) {
    const FloorOrdinal floor = laws[level.transmitter]->transmitter.floor;
    auto found = std::ranges::find(votes, floor, &FloorProbability::floor);
    if (found == votes.end()) found = votes.insert(votes.end(), FloorProbability{floor, 0.0});
    const double voice = std::exp(static_cast<double>(level.rss_dbm - loudest) / kVoteDb);
    found->probability += voice;
    sum += voice;
  }
  for (auto& each : votes) each.probability /= sum;
  most_probable_first(votes);
}

std::vector<std::optional<PathLoss>> fit_path_loss(const RadioMap& map) {
  std::vector<std::map<FloorOrdinal, std::vector<Sample>>> samples(map.transmitters().size());
  for (const MapPoint& point : map.points()) {
    for (const MapLevel& level : map.levels(point)) {
      samples[level.transmitter][point.place.floor].push_back({point.place.point, static_cast<double>(level.mean_dbm)});
    }
  }
  std::vector<std::optional<PathLoss>> laws;
  for (auto& by_floor : samples) laws.push_back(fit(by_floor));
  return laws;
}

}  // namespace wayfuse
