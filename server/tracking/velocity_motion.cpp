#include "server/tracking/velocity_motion.hpp"

#include <cmath>

#include "server/tracking/noise.hpp"

namespace wayfuse {

void VelocityMotion::propagate(ParticleCloud& cloud, const Motion& motion, Random& random) const {
  const auto dt_s = static_cast<float>(motion.dt_s);
  const double root_s = std::sqrt(motion.dt_s);
  const auto c = static_cast<float>(std::cos(settings_.axis_rad)), s = static_cast<float>(std::sin(settings_.axis_rad));
  const auto along_m = static_cast<float>(settings_.along_sigma_m_rts * root_s);
  const auto across_m = static_cast<float>(settings_.across_sigma_m_rts * root_s);
  const auto along_mps = static_cast<float>(settings_.along_sigma_mps_rts * root_s);
  const auto across_mps = static_cast<float>(settings_.across_sigma_mps_rts * root_s);
  const Noise place(random);
  const Noise speed(random);
  const auto x_m = cloud.x_m(), y_m = cloud.y_m(), vx_mps = cloud.vx_mps(), vy_mps = cloud.vy_mps();
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const Noise::Pair p = place.normal(i);
    const Noise::Pair v = speed.normal(i);
    const float pa = along_m * p.first, pc = across_m * p.second;
    const float va = along_mps * v.first, vc = across_mps * v.second;
    x_m[i] += dt_s * vx_mps[i] + c * pa - s * pc;
    y_m[i] += dt_s * vy_mps[i] + s * pa + c * pc;
    vx_mps[i] += c * va - s * vc;
    vy_mps[i] += s * va + c * vc;
  }
}

State VelocityMotion::propagate(const State& state, const Motion& motion) const {
  return {state.x_m + motion.dt_s * state.vx_mps, state.y_m + motion.dt_s * state.vy_mps, state.vx_mps, state.vy_mps};
}

StateMatrix VelocityMotion::jacobian(const State&, const Motion& motion) const {
  const double t = motion.dt_s;
  return {1, 0, t, 0,  //
          0, 1, 0, t,  //
          0, 0, 1, 0,  //
          0, 0, 0, 1};
}

StateMatrix VelocityMotion::noise(const State&, const Motion& motion) const {
  const double c = std::cos(settings_.axis_rad), s = std::sin(settings_.axis_rad);
  StateMatrix q{};
  const auto fill = [&](std::size_t first, double along, double across) {
    const double a2 = along * along * motion.dt_s, b2 = across * across * motion.dt_s;
    q[first * 4 + first] = c * c * a2 + s * s * b2;
    q[(first + 1) * 4 + first + 1] = s * s * a2 + c * c * b2;
    q[first * 4 + first + 1] = q[(first + 1) * 4 + first] = c * s * (a2 - b2);
  };
  fill(0, settings_.along_sigma_m_rts, settings_.across_sigma_m_rts);
  fill(2, settings_.along_sigma_mps_rts, settings_.across_sigma_mps_rts);
  return q;
}

}  // namespace wayfuse
