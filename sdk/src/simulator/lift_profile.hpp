#pragma once

#include "sdk/src/simulator/world.hpp"

namespace wayfuse::simulator {

/// How one lift drives: what its passengers are spared, and what they feel.
struct LiftSettings {
  double acceleration_mps2 = 0.8;   ///< 0.5..1.2
  double speed_mps = 1.6;           ///< 1..2.5
  double jerk_mps3 = 1.2;           ///< 0.8..2: how fast the acceleration itself comes and goes
};

/// The lift in that shaft: the same in every walk through that world, another one in the next shaft.
LiftSettings lift_at(const World& world, BuildingPoint shaft);

/// One ride from rest to rest: acceleration that comes and goes evenly, cruise, the same backwards.
class LiftProfile {
 public:
  /// Over `far_m` > 0; a short ride stays below the lift's speed, and below its acceleration.
  static LiftProfile of(const LiftSettings& settings, double far_m);

  double lasts_s() const { return 2.0 * speeding_s_ + cruise_s_; }
  double top_mps() const { return acceleration_mps2_ * (speeding_s_ - ramp_s_); }
  double acceleration_mps2(double t_s) const;   ///< along the ride
  double travelled_m(double t_s) const;

 private:
  double speeding_m(double t_s) const;          // within the first pulse

  double acceleration_mps2_ = 0.0;              // its plateau
  double ramp_s_ = 0.0;                         // from none to the plateau
  double speeding_s_ = 0.0;                     // ramp, plateau, ramp
  double cruise_s_ = 0.0;
};

}  // namespace wayfuse::simulator
