#include "server/pipeline/field_measurement.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse {

void FieldMeasurement::weigh(const ParticleCloud& cloud, std::span<float> log_weight) const {
  const std::size_t size = cloud.size();
  scratch_.x_m.resize(size);
  scratch_.y_m.resize(size);
  scratch_.log_likelihood.assign(size, 0.0f);
  const auto dx = static_cast<float>(carried_.x_m), dy = static_cast<float>(carried_.y_m);
  const bool biased = cloud.has(ParticleCloud::kHeadingBias), scaled = cloud.has(ParticleCloud::kStrideScale);
  for (std::size_t i = 0; i < size; ++i) {
    const float stride = scaled ? cloud.stride_scale()[i] : 1.0f;
    const float c = stride * (biased ? std::cos(cloud.heading_bias_rad()[i]) : 1.0f);
    const float s = stride * (biased ? std::sin(cloud.heading_bias_rad()[i]) : 0.0f);
    scratch_.x_m[i] = cloud.x_m()[i] - (c * dx - s * dy);
    scratch_.y_m[i] = cloud.y_m()[i] - (s * dx + c * dy);
  }
  locator_.add_log_likelihood(scratch_.x_m, scratch_.y_m, floor_, scratch_.log_likelihood);
  float best = -INFINITY;
  for (const float each : scratch_.log_likelihood) best = std::isfinite(each) ? std::max(best, each) : best;
  if (!std::isfinite(best)) return;  // the locator says nothing here: every particle weighs as before
  const auto weight = static_cast<float>(weight_), outlier = static_cast<float>(outlier_);
  for (std::size_t i = 0; i < size; ++i) {
    log_weight[i] += std::log(std::exp(weight * (scratch_.log_likelihood[i] - best)) + outlier);
  }
}

}  // namespace wayfuse
