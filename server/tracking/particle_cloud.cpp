#include "server/tracking/particle_cloud.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "server/tracking/particle_kernels.hpp"

namespace wayfuse {

ParticleCloud::ParticleCloud(std::size_t size, unsigned optional_columns) : size_(size) {
  const std::size_t padded = (size + 15) / 16 * 16;
  const unsigned columns = optional_columns | 1u << kX | 1u << kY | 1u << kLogWeight;
  for (unsigned column = 0; column < kColumns; ++column) {
    if (columns >> column & 1u) column_[column].assign(padded, 0.0f);
  }
  if (!(optional_columns & kLogsOnly)) weight_.assign(padded, 0.0f);
  std::ranges::fill(column_[kLogWeight], -std::numeric_limits<float>::infinity());
  level();
}

void ParticleCloud::level() {
  std::ranges::fill(log_weight(), -std::log(static_cast<float>(size_)));
  std::ranges::fill(weight_, 1.0f / static_cast<float>(size_));
  effective_size_ = static_cast<double>(size_);
}

void ParticleCloud::shift(double dx_m, double dy_m) {
  for (float& x : x_m()) x = static_cast<float>(static_cast<double>(x) + dx_m);
  for (float& y : y_m()) y = static_cast<float>(static_cast<double>(y) + dy_m);
}

bool ParticleCloud::normalise() {
  float* const log_weights = column_[kLogWeight].data();
  const float most = kernels::clean_and_max(log_weights, padded_size());
  if (!std::isfinite(most)) {
    level();
    return false;
  }
  float* const weights = weight_.empty() ? spare_.get(padded_size()).data() : weight_.data();
  kernels::exponentials(log_weights, padded_size(), most, weights);
  std::array<float, 16> sums, squares;
  kernels::sums_of_sixteen(weights, padded_size(), sums, squares);
  double sum = 0.0, square = 0.0;
  for (const float each : sums) sum += static_cast<double>(each);
  for (const float each : squares) square += static_cast<double>(each);
  effective_size_ = sum * sum / square;
  const float shift = most + static_cast<float>(std::log(sum));
  kernels::shift_and_scale(log_weights, shift, weights, static_cast<float>(1.0 / sum), padded_size());
  return true;
}

void ParticleCloud::take_ancestors() {
  const auto from = ancestors_.get(padded_size());
  std::fill(from.begin() + static_cast<std::ptrdiff_t>(size_), from.end(), 0u);
  assert(std::ranges::all_of(from, [this](std::uint32_t ancestor) { return ancestor < size_; }));
  for (unsigned column = 0; column < kLogWeight; ++column) {
    auto& values = column_[column];
    if (values.empty()) continue;
    kernels::gather(values.data(), from.data(), padded_size(), spare_.get(values.size()).data());
    spare_.swap(values);
  }
  level();
}

}  // namespace wayfuse
