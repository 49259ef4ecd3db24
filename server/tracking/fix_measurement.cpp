#include "server/tracking/fix_measurement.hpp"

#include <algorithm>

namespace wayfuse {

void FixMeasurement::weigh(const ParticleCloud& cloud, std::span<float> log_weight) const {
  const auto x_m = cloud.x_m();
  const auto y_m = cloud.y_m();
  const auto zx = static_cast<float>(x_m_);
  const auto zy = static_cast<float>(y_m_);
  const auto scale = static_cast<float>(-0.5 / (sigma_m_ * sigma_m_));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float dx = x_m[i] - zx;
    const float dy = y_m[i] - zy;
    log_weight[i] += scale * (dx * dx + dy * dy);
  }
}

void FixMeasurement::residual(const State& state, std::span<double> out) const {
  out[0] = x_m_ - state.x_m;
  out[1] = y_m_ - state.y_m;
}

void FixMeasurement::jacobian(const State&, std::span<double> out) const {
  std::ranges::fill(out.first(8), 0.0);
  out[0] = out[5] = 1.0;
}

void FixMeasurement::variance(std::span<double> out) const { out[0] = out[1] = sigma_m_ * sigma_m_; }

}  // namespace wayfuse
