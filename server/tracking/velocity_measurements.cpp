#include "server/tracking/velocity_measurements.hpp"

#include <algorithm>
#include <cmath>

#include "wayfuse/proto/heading.hpp"

namespace wayfuse {
namespace {

constexpr double kLeastSpeedMps = 0.05;

double speed_of(const State& state) { return std::max(std::hypot(state.vx_mps, state.vy_mps), kLeastSpeedMps); }

}  // namespace

void SpeedMeasurement::weigh(const ParticleCloud& cloud, std::span<float> log_weight) const {
  const auto vx_mps = cloud.vx_mps(), vy_mps = cloud.vy_mps();
  const auto z = static_cast<float>(speed_mps_);
  const auto scale = static_cast<float>(-0.5 / (sigma_mps_ * sigma_mps_));
  for (std::size_t i = 0; i < vx_mps.size(); ++i) {
    const float error = z - std::sqrt(vx_mps[i] * vx_mps[i] + vy_mps[i] * vy_mps[i]);
    log_weight[i] += scale * error * error;
  }
}

void SpeedMeasurement::residual(const State& state, std::span<double> out) const {
  out[0] = speed_mps_ - std::hypot(state.vx_mps, state.vy_mps);
}

void SpeedMeasurement::jacobian(const State& state, std::span<double> out) const {
  const double speed = speed_of(state);
  out[0] = out[1] = 0.0;
  out[2] = state.vx_mps / speed;
  out[3] = state.vy_mps / speed;
}

void DirectionMeasurement::weigh(const ParticleCloud& cloud, std::span<float> log_weight) const {
  const auto vx_mps = cloud.vx_mps(), vy_mps = cloud.vy_mps();
  const auto scale = static_cast<float>(-0.5 / (sigma_rad_ * sigma_rad_));
  for (std::size_t i = 0; i < vx_mps.size(); ++i) {
    const double angle = std::atan2(static_cast<double>(vy_mps[i]), static_cast<double>(vx_mps[i]));
    const auto error = static_cast<float>(wrap_angle_rad(heading_rad_ - angle));
    log_weight[i] += scale * error * error;
  }
}

void DirectionMeasurement::residual(const State& state, std::span<double> out) const {
  out[0] = wrap_angle_rad(heading_rad_ - std::atan2(state.vy_mps, state.vx_mps));
}

void DirectionMeasurement::jacobian(const State& state, std::span<double> out) const {
  const double squared = speed_of(state) * speed_of(state);
  out[0] = out[1] = 0.0;
  out[2] = -state.vy_mps / squared;
  out[3] = state.vx_mps / squared;
}

}  // namespace wayfuse
