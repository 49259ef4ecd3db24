#include "server/tracking/steps_motion.hpp"

#include <algorithm>
#include <cmath>

#include "server/tracking/noise.hpp"

namespace wayfuse {

unsigned StepsMotion::columns() const {
  return (settings_.bias_sigma_rad > 0.0 || settings_.bias_drift_rad_rts > 0.0 ? ParticleCloud::kBias : 0u) |
         (settings_.scale_sigma > 0.0 ? ParticleCloud::kScale : 0u);
}

double StepsMotion::length_sigma_m(const Motion& motion) const {
  return motion.distance_sigma_m > 0.0 ? motion.distance_sigma_m : settings_.length_share * motion.distance_m;
}

double StepsMotion::heading_sigma_rad(const Motion& motion) const {
  // A constant heading error that the particles carry is not drawn again at every step.
  const double stated = columns() & ParticleCloud::kBias ? 0.0 : motion.heading_sigma_rad;
  return std::hypot(stated, settings_.heading_sigma_rad);
}

void StepsMotion::start(ParticleCloud& cloud, Random& random) const {
  const Noise noise(random);
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const Noise::Pair n = noise.normal(i);
    if (cloud.has(ParticleCloud::kHeadingBias)) cloud.heading_bias_rad()[i] = static_cast<float>(settings_.bias_sigma_rad) * n.first;
    if (cloud.has(ParticleCloud::kStrideScale)) {
      cloud.stride_scale()[i] = std::max(0.2f, 1.0f + static_cast<float>(settings_.scale_sigma) * n.second);
    }
  }
}

void StepsMotion::propagate(ParticleCloud& cloud, const Motion& motion, Random& random) const {
  const auto distance_m = static_cast<float>(motion.distance_m);
  const auto distance_sigma = static_cast<float>(length_sigma_m(motion));
  const auto heading_rad = static_cast<float>(motion.heading_rad);
  const auto heading_sigma = static_cast<float>(heading_sigma_rad(motion));
  const auto spread_m = static_cast<float>(motion.spread_m);
  const auto drift = static_cast<float>(settings_.bias_drift_rad_rts * std::sqrt(motion.dt_s));
  const bool biased = cloud.has(ParticleCloud::kHeadingBias);
  const bool scaled = cloud.has(ParticleCloud::kStrideScale);
  const Noise step(random);
  const Noise walk(random);
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const Noise::Pair n = step.normal(i);
    if (!motion.at_rest && distance_m > 0.0f) {
      float angle = heading_rad + heading_sigma * n.first;
      if (biased) angle += cloud.heading_bias_rad()[i];
      float length = distance_m + distance_sigma * n.second;
      if (scaled) length *= cloud.stride_scale()[i];
      cloud.x_m()[i] += length * std::cos(angle);
      cloud.y_m()[i] += length * std::sin(angle);
    }
    if (spread_m > 0.0f || (biased && drift > 0.0f)) {
      const Noise::Pair w = walk.normal(i);
      if (biased) cloud.heading_bias_rad()[i] += drift * w.first;
      cloud.x_m()[i] += spread_m * w.first;
      cloud.y_m()[i] += spread_m * w.second;
    }
  }
}

State StepsMotion::propagate(const State& state, const Motion& motion) const {
  const double distance_m = motion.at_rest ? 0.0 : motion.distance_m;
  const double dx_m = distance_m * std::cos(motion.heading_rad);
  const double dy_m = distance_m * std::sin(motion.heading_rad);
  return {state.x_m + dx_m, state.y_m + dy_m, dx_m / motion.dt_s, dy_m / motion.dt_s};
}

StateMatrix StepsMotion::jacobian(const State&, const Motion&) const {
  StateMatrix f{};
  f[0] = f[5] = 1.0;
  return f;
}

StateMatrix StepsMotion::noise(const State&, const Motion& motion) const {
  const double along_m = motion.at_rest ? 0.0 : length_sigma_m(motion);
  const double across_m = motion.at_rest ? 0.0 : motion.distance_m * std::min(1.0, heading_sigma_rad(motion));
  const double c = std::cos(motion.heading_rad), s = std::sin(motion.heading_rad);
  const double a2 = along_m * along_m, b2 = across_m * across_m, spread2 = motion.spread_m * motion.spread_m;
  const double xx = c * c * a2 + s * s * b2 + spread2, yy = s * s * a2 + c * c * b2 + spread2, xy = c * s * (a2 - b2);
  const double t = motion.dt_s;
  return {xx,     xy,     xx / t,       xy / t,        //
          xy,     yy,     xy / t,       yy / t,        //
          xx / t, xy / t, xx / (t * t), xy / (t * t),  //
          xy / t, yy / t, xy / (t * t), yy / (t * t)};
}

}  // namespace wayfuse
