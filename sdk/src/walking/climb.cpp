#include "sdk/src/walking/climb.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse {
namespace {

constexpr double kSmoothS = 1.0;        // the barometer of a phone whispers 0.1 m
constexpr double kRateS = 2.0;
constexpr double kClimbingMps = 0.12;   // slower is weather or a ramp
constexpr double kDoorS = 10.0;         // a longer silence: start again, weather has moved on

// International standard atmosphere; differences of height are within 2 % indoors.
double height_m(double pressure_hpa) { return 44330.0 * (1.0 - std::pow(pressure_hpa / 1013.25, 0.1903)); }

}  // namespace

void Climb::feed(const MargSample& sample, bool walking) {
  if (!sample.pressure_hpa || !(*sample.pressure_hpa > 300.0 && *sample.pressure_hpa < 1100.0)) return;
  const double now_m = height_m(*sample.pressure_hpa), dt_s = started_ ? seconds(sample.time - time_) : 0.0;
  if (started_ && dt_s <= 0.0) return;
  time_ = sample.time;
  if (!started_ || dt_s > kDoorS) {
    taken_m_ += started_ ? now_m - smooth_m_ : now_m;
    smooth_m_ = now_m;
    rate_mps_ = 0.0;
    started_ = true;
    return;
  }
  const double before = smooth_m_, rate = std::min(1.0, dt_s / kRateS);
  smooth_m_ += std::min(1.0, dt_s / kSmoothS) * (now_m - smooth_m_);
  rate_mps_ += rate * ((smooth_m_ - before) / dt_s - rate_mps_);
  walking_share_ += rate * ((walking ? 1.0 : 0.0) - walking_share_);
}

std::optional<double> Climb::take() {
  if (!started_) return std::nullopt;
  const double climbed = smooth_m_ - taken_m_;
  taken_m_ = smooth_m_;
  return climbed;
}

Climbing Climb::climbing() const {
  if (std::abs(rate_mps_) < kClimbingMps) return Climbing::kNone;
  return walking_share_ > 0.5 ? Climbing::kStairs : Climbing::kLift;
}

}  // namespace wayfuse
