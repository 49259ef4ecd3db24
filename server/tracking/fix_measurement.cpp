#include "server/tracking/fix_measurement.hpp"

#include <algorithm>

#include "server/tracking/particle_kernels.hpp"

namespace wayfuse {

void FixMeasurement::weigh(const ParticleCloud& cloud, std::span<float> log_weight) const {
  kernels::add_squared_distance(cloud.x_m(), cloud.y_m(), static_cast<float>(x_m_), static_cast<float>(y_m_),
                                static_cast<float>(-0.5 / (sigma_m_ * sigma_m_)), log_weight);
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
