#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>

namespace wayfuse {

/// How well the nearest fingerprints fit: the mean of the `kCount` smallest distances, of all of them where there are fewer. At least one.
template <std::size_t kCount>
float mean_of_smallest(std::span<const float> distances) {
  std::array<float, kCount> smallest;
  smallest.fill(std::numeric_limits<float>::infinity());
  for (const float distance : distances) {
    if (distance >= smallest.back()) continue;
    std::size_t at = kCount - 1;
    for (; at > 0 && smallest[at - 1] > distance; --at) smallest[at] = smallest[at - 1];
    smallest[at] = distance;
  }
  const auto count = static_cast<std::ptrdiff_t>(std::min(kCount, distances.size()));
  return std::accumulate(smallest.begin(), smallest.begin() + count, 0.0f) / static_cast<float>(count);
}

}  // namespace wayfuse
