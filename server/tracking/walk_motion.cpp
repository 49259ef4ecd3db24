#include "server/tracking/walk_motion.hpp"

#include <algorithm>
#include <cmath>

#include "server/tracking/particle_kernels.hpp"

namespace wayfuse {

double WalkMotion::displacement_sigma_m(const Motion& motion) const {
  if (motion.at_rest) return motion.spread_m;
  double sigma_m = 0.5 * motion.dt_s * motion.dt_s * settings_.acceleration_sigma_mps2;
  if (settings_.acceleration_sigma_mps2 == 0.0) {
    const double across_m = motion.distance_m * std::min(motion.heading_sigma_rad, 1.0);  // a lost heading: anywhere around
    sigma_m = std::max(motion.distance_sigma_m, across_m);
  }
  return std::hypot(std::max(sigma_m, settings_.blur_m_rts * std::sqrt(motion.dt_s)), motion.spread_m);
}

void WalkMotion::propagate(ParticleCloud& cloud, const Motion& motion, Random& random) const {
  const auto dx_m = static_cast<float>(motion.distance_m * std::cos(motion.heading_rad));
  const auto dy_m = static_cast<float>(motion.distance_m * std::sin(motion.heading_rad));
  const auto sigma_m = static_cast<float>(displacement_sigma_m(motion));
  kernels::walk(cloud.x_m().data(), cloud.y_m().data(), cloud.padded_size(), dx_m, dy_m, sigma_m, random.bits());
}

State WalkMotion::propagate(const State& state, const Motion& motion) const {
  const double dx_m = motion.distance_m * std::cos(motion.heading_rad);
  const double dy_m = motion.distance_m * std::sin(motion.heading_rad);
  return {state.x_m + dx_m, state.y_m + dy_m, dx_m / motion.dt_s, dy_m / motion.dt_s};
}

StateMatrix WalkMotion::jacobian(const State&, const Motion&) const {
  StateMatrix f{};
  f[0] = f[5] = 1.0;
  return f;
}

StateMatrix WalkMotion::noise(const State&, const Motion& motion) const {
  const double sigma_m = displacement_sigma_m(motion);
  StateMatrix q{};
  q[0] = q[5] = sigma_m * sigma_m;
  q[10] = q[15] = sigma_m * sigma_m / (motion.dt_s * motion.dt_s);
  q[2] = q[8] = q[7] = q[13] = sigma_m * sigma_m / motion.dt_s;  // the same draw moves the point and sets the speed
  return q;
}

}  // namespace wayfuse
