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

ResolvedVelocityMeasurement::ResolvedVelocityMeasurement(double speed_mps, double speed_sigma_mps, double heading_rad, double heading_sigma_rad)
    : speed_mps_(speed_mps),
      cos_(std::cos(heading_rad)),
      sin_(std::sin(heading_rad)),
      along_sigma_mps_(speed_sigma_mps),
      across_sigma_mps_(std::max(speed_mps, kLeastSpeedMps) * heading_sigma_rad) {}

void ResolvedVelocityMeasurement::weigh(const ParticleCloud& cloud, std::span<float> log_weight) const {
  const auto vx_mps = cloud.vx_mps(), vy_mps = cloud.vy_mps();
  const auto z = static_cast<float>(speed_mps_), c = static_cast<float>(cos_), s = static_cast<float>(sin_);
  const auto along_scale = static_cast<float>(-0.5 / (along_sigma_mps_ * along_sigma_mps_));
  const auto across_scale = static_cast<float>(-0.5 / (across_sigma_mps_ * across_sigma_mps_));
  for (std::size_t i = 0; i < vx_mps.size(); ++i) {
    const float along = z - (c * vx_mps[i] + s * vy_mps[i]), across = s * vx_mps[i] - c * vy_mps[i];
    log_weight[i] += along_scale * along * along + across_scale * across * across;
  }
}

void ResolvedVelocityMeasurement::residual(const State& state, std::span<double> out) const {
  out[0] = speed_mps_ - (cos_ * state.vx_mps + sin_ * state.vy_mps);
  out[1] = sin_ * state.vx_mps - cos_ * state.vy_mps;
}

void ResolvedVelocityMeasurement::jacobian(const State&, std::span<double> out) const {
  out[0] = out[1] = out[4] = out[5] = 0.0;
  out[2] = cos_, out[3] = sin_;
  out[6] = -sin_, out[7] = cos_;
}

}  // namespace wayfuse
