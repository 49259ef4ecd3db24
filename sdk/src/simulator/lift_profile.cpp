#include "sdk/src/simulator/lift_profile.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse::simulator {

LiftSettings lift_at(const World& world, BuildingPoint shaft) {
  const auto place = static_cast<std::uint64_t>(std::llround(100.0 * shaft.x_m) * 1'000'003 + std::llround(100.0 * shaft.y_m));
  Random random(world.seed * 0x9E3779B97F4A7C15u + place);
  LiftSettings lift;
  lift.acceleration_mps2 = 0.5 + 0.7 * random.uniform();
  lift.speed_mps = 1.0 + 1.5 * random.uniform();
  lift.jerk_mps3 = 0.8 + 1.2 * random.uniform();
  return lift;
}

LiftProfile LiftProfile::of(const LiftSettings& settings, double far_m) {
  LiftProfile ride;
  ride.acceleration_mps2_ = settings.acceleration_mps2;
  ride.ramp_s_ = settings.acceleration_mps2 / settings.jerk_mps3;
  // Up to speed v takes v / a + r and half of that times v of the way, and down again as much: v^2 / a + v r <= far.
  const double a = ride.acceleration_mps2_, r = ride.ramp_s_;
  const double top_mps = std::min(settings.speed_mps, 0.5 * a * (std::sqrt(r * r + 4.0 * far_m / a) - r));
  if (top_mps < a * r) {   // no plateau: acceleration only comes and goes, v = jerk ramp^2, far = 2 v ramp
    const double speed_ramp_s = std::sqrt(settings.speed_mps / settings.jerk_mps3);
    ride.ramp_s_ = std::min(std::cbrt(0.5 * far_m / settings.jerk_mps3), speed_ramp_s);
    ride.acceleration_mps2_ = settings.jerk_mps3 * ride.ramp_s_;
    ride.speeding_s_ = 2.0 * ride.ramp_s_;
  } else {
    ride.speeding_s_ = top_mps / a + r;
  }
  ride.cruise_s_ = std::max(0.0, far_m / ride.top_mps() - ride.speeding_s_);
  return ride;
}

double LiftProfile::acceleration_mps2(double t_s) const {
  const double left_s = lasts_s() - t_s;
  const auto pulse = [this](double at_s) { return acceleration_mps2_ * std::clamp(std::min(at_s, speeding_s_ - at_s) / ramp_s_, 0.0, 1.0); };
  return pulse(t_s) - pulse(left_s);
}

// Ramp: j t^3 / 6. Plateau after it: a (s^2 / 2 + r s / 2 + r^2 / 6), s into the plateau. The last ramp mirrors the first.
double LiftProfile::speeding_m(double t_s) const {
  const double a = acceleration_mps2_, r = ramp_s_, plateau_s = speeding_s_ - 2.0 * r;
  const double t = std::clamp(t_s, 0.0, speeding_s_);
  if (t < r) return a * t * t * t / (6.0 * r);
  const auto plateau_m = [&](double s) { return a * (0.5 * s * s + 0.5 * r * s + r * r / 6.0); };
  if (t < r + plateau_s) return plateau_m(t - r);
  const double s = t - r - plateau_s;
  return plateau_m(plateau_s) + a * (plateau_s + 0.5 * r) * s + 0.5 * a * s * s - a * s * s * s / (6.0 * r);
}

double LiftProfile::travelled_m(double t_s) const {
  const double up_to_speed_m = speeding_m(speeding_s_), left_s = lasts_s() - t_s;
  if (t_s <= speeding_s_) return speeding_m(t_s);
  if (left_s > speeding_s_) return up_to_speed_m + top_mps() * (t_s - speeding_s_);
  return 2.0 * up_to_speed_m + top_mps() * cruise_s_ - speeding_m(left_s);
}

}  // namespace wayfuse::simulator
