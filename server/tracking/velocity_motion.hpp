#pragma once

#include "server/tracking/motion_model.hpp"

namespace wayfuse {

/// Random walks of position and velocity along and across an axis, per root second.
struct VelocitySettings {
  double axis_rad = 0.0;               ///< of `along`, from the x axis
  double along_sigma_m_rts = 0.0316;   ///< sqrt(0.001) [P4]
  double along_sigma_mps_rts = 0.1;    ///< sqrt(0.01) [P4]
  double across_sigma_m_rts = 0.0316;
  double across_sigma_mps_rts = 0.1;
};

/// Constant velocity: x <- x + T v, with noise on position and velocity [P4 eqs. 1-2; P5 eqs. 1, 3].
///
/// With equal noises along and across the axis does not matter: `constant-velocity`. With an axis it is the street of [P5], whose
/// state [x_a, v_a, x_c, v_c] is the same vector seen from a turned frame: the noise is turned, not the state. Immutable.
class VelocityMotion final : public MotionModel {
 public:
  explicit VelocityMotion(const VelocitySettings& settings) : settings_(settings) {}
  unsigned columns() const override { return ParticleCloud::kVelocity; }
  bool uses_heading() const override { return false; }
  bool uses_distance() const override { return false; }
  void propagate(ParticleCloud& cloud, const Motion& motion, Random& random) const override;
  State propagate(const State& state, const Motion& motion) const override;
  StateMatrix jacobian(const State& state, const Motion& motion) const override;
  StateMatrix noise(const State& state, const Motion& motion) const override;

 private:
  VelocitySettings settings_;
};

}  // namespace wayfuse
