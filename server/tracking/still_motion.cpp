#include "server/tracking/still_motion.hpp"

#include <cmath>

#include "server/tracking/particle_kernels.hpp"

namespace wayfuse {

double StillMotion::sigma_m(const Motion& motion) const { return settings_.wander_m_rts * std::sqrt(motion.dt_s); }

void StillMotion::propagate(ParticleCloud& cloud, const Motion& motion, Random& random) const {
  const auto sigma = static_cast<float>(sigma_m(motion));
  kernels::walk(cloud.x_m().data(), cloud.y_m().data(), cloud.padded_size(), 0.0f, 0.0f, sigma, random.bits());
}

StateMatrix StillMotion::jacobian(const State&, const Motion&) const {
  StateMatrix f{};
  f[0] = f[5] = 1.0;
  return f;
}

StateMatrix StillMotion::noise(const State&, const Motion& motion) const {
  StateMatrix q{};
  q[0] = q[5] = sigma_m(motion) * sigma_m(motion);
  return q;
}

}  // namespace wayfuse
