#pragma once

#include "server/tracking/motion_model.hpp"

namespace wayfuse {

struct WalkSettings {
  double acceleration_sigma_mps2 = 0.0;  ///< of n_x, n_y in [P1 eq. 12]; 0 = what the phone states about itself
  double blur_m_rts = 0.3;               ///< least blur, metres per root second: covers what the phone does not know of its errors
};

/// Heading and speed move the walker, an unknown acceleration blurs: x <- x + T v cos(heading) + T^2/2 n_x [P1 eq. 12].
///
/// The variance of n comes from the phone: the stated sigma of distance along, and of heading times distance across, read as
/// the displacement T^2/2 n they would cause (the larger of the two, both axes alike as printed). Position only: the
/// velocity of the state is set to what the motion says. Immutable.
class WalkMotion final : public MotionModel {
 public:
  explicit WalkMotion(const WalkSettings& settings) : settings_(settings) {}
  unsigned columns() const override { return 0; }
  bool uses_heading() const override { return true; }
  bool uses_distance() const override { return true; }
  void propagate(ParticleCloud& cloud, const Motion& motion, Random& random) const override;
  State propagate(const State& state, const Motion& motion) const override;
  StateMatrix jacobian(const State& state, const Motion& motion) const override;
  StateMatrix noise(const State& state, const Motion& motion) const override;

  /// Of the displacement on one axis.
  double displacement_sigma_m(const Motion& motion) const;

 private:
  WalkSettings settings_;
};

}  // namespace wayfuse
