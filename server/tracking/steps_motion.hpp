#pragma once

#include "server/tracking/motion_model.hpp"

namespace wayfuse {

struct StepsSettings {
  double length_share = 0.1;           ///< sigma of a step's length as a share of it, where the phone states none
  double heading_sigma_rad = 0.05;     ///< added to each step's stated heading sigma, drawn anew for every step
  double bias_sigma_rad = 0.0;         ///< each particle's constant heading error at the start; 0 = no such state
  double bias_drift_rad_rts = 0.0;     ///< its random walk, per root second
  double scale_sigma = 0.0;            ///< each particle's constant stride factor about 1; 0 = no such state
};

/// Pedestrian dead reckoning, one step at a time: x <- x + SL cos(theta), y <- y + SL sin(theta) [P2, P3 eq. 7].
///
/// Every particle draws its own length and heading error for the interval; constant errors (compass, stride) may live in the
/// particles, where evidence selects them. For the Kalman family the noise is the displacement's covariance along and
/// across the heading. At rest nothing moves but for a pause's spread. Immutable.
class StepsMotion final : public MotionModel {
 public:
  explicit StepsMotion(const StepsSettings& settings) : settings_(settings) {}
  unsigned columns() const override;
  bool uses_heading() const override { return true; }
  bool uses_distance() const override { return true; }
  void start(ParticleCloud& cloud, Random& random) const override;
  void propagate(ParticleCloud& cloud, const Motion& motion, Random& random) const override;
  State propagate(const State& state, const Motion& motion) const override;
  StateMatrix jacobian(const State& state, const Motion& motion) const override;
  StateMatrix noise(const State& state, const Motion& motion) const override;

 private:
  double length_sigma_m(const Motion& motion) const;
  double heading_sigma_rad(const Motion& motion) const;
  StepsSettings settings_;
};

}  // namespace wayfuse
