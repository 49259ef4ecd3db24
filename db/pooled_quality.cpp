#include <algorithm>
#include <utility>

#include "db/radio_map_record.hpp"

namespace wayfuse {
namespace {

std::vector<float> pooled_quantiles(std::span<const MapQuality> walks) {
  std::vector<std::pair<float, double>> weighed;
  double total = 0.0;
  for (const MapQuality& walk : walks) {
    if (walk.error_quantiles_m.empty()) continue;
    const double weight = static_cast<double>(walk.instants) / static_cast<double>(walk.error_quantiles_m.size());
    for (const float error_m : walk.error_quantiles_m) weighed.emplace_back(error_m, weight);
    total += static_cast<double>(walk.instants);
  }
  std::ranges::sort(weighed);
  std::vector<float> found;
  double below = 0.0;
  for (const auto& [error_m, weight] : weighed) {
    below += weight;
    while (found.size() <= 100 && below >= 0.01 * static_cast<double>(found.size()) * total * (1.0 - 1e-9)) found.push_back(error_m);
  }
  return found;
}

}  // namespace

PooledQuality pool(std::span<const MapQuality> walks) {
  PooledQuality pooled;
  for (const MapQuality& walk : walks) {
    pooled.walks++;
    pooled.asked += walk.asked;
    pooled.instants += walk.instants;
    const auto weight = static_cast<double>(walk.instants);
    pooled.mean_m += weight * walk.mean_m;
    pooled.floor_hit += weight * walk.floor_hit;
    pooled.in68 += weight * walk.in68;
    pooled.in95 += weight * walk.in95;
  }
  if (pooled.instants == 0) return pooled;
  for (double* sum : {&pooled.mean_m, &pooled.floor_hit, &pooled.in68, &pooled.in95}) *sum /= static_cast<double>(pooled.instants);
  pooled.error_quantiles_m = pooled_quantiles(walks);
  if (pooled.error_quantiles_m.size() == 101) {
    pooled.median_m = static_cast<double>(pooled.error_quantiles_m[50]);
    pooled.p90_m = static_cast<double>(pooled.error_quantiles_m[90]);
  }
  return pooled;
}

}  // namespace wayfuse
