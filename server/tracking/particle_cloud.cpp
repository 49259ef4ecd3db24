#include "server/tracking/particle_cloud.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace wayfuse {

ParticleCloud::ParticleCloud(std::size_t size, unsigned optional_columns) : size_(size), ancestors_(size) {
  const std::size_t padded = (size + 15) / 16 * 16;
  const unsigned columns = optional_columns | 1u << kX | 1u << kY | 1u << kLogWeight;
  for (unsigned column = 0; column < kColumns; ++column) {
    if (columns >> column & 1u) column_[column].assign(padded, 0.0f);
  }
  spare_.assign(padded, 0.0f);
}

bool ParticleCloud::normalise() {
  const std::span<float> weights = log_weight();
  float most = -INFINITY;
  for (float& weight : weights) {
    if (std::isnan(weight)) weight = -INFINITY;  // a particle nobody can weigh counts for nothing
    most = std::max(most, weight);
  }
  if (!std::isfinite(most)) {
    std::ranges::fill(weights, -std::log(static_cast<float>(size_)));
    return false;
  }
  double sum = 0.0;
  for (const float weight : weights) sum += std::exp(static_cast<double>(weight - most));
  const float shift = most + static_cast<float>(std::log(sum));
  for (float& weight : weights) weight -= shift;
  return true;
}

double ParticleCloud::effective_size() const {
  double squares = 0.0;
  for (const float weight : log_weight()) squares += std::exp(2.0 * static_cast<double>(weight));
  return squares > 0.0 ? 1.0 / squares : 0.0;
}

void ParticleCloud::take_ancestors() {
  for (unsigned column = 0; column < kLogWeight; ++column) {
    auto& values = column_[column];
    if (values.empty()) continue;
    for (std::size_t i = 0; i < size_; ++i) {
      assert(ancestors_[i] < size_);
      spare_[i] = values[ancestors_[i]];
    }
    values.swap(spare_);
  }
  std::ranges::fill(log_weight(), -std::log(static_cast<float>(size_)));
}

}  // namespace wayfuse
