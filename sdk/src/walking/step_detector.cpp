#include "sdk/src/walking/step_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wayfuse {

double StepDetector::smooth(double value, double dt_s) {
  const double gain = 1.0 - std::exp(-2.0 * std::numbers::pi * settings_.cutoff_hz * dt_s);
  first_ += gain * (value - first_);
  second_ += gain * (first_ - second_);
  return second_;
}

std::optional<Step> StepDetector::feed(PhoneTime time, double acceleration_mps2) {
  const double dt_s = started_ ? seconds(time - time_) : 0.0;
  time_ = time;
  if (!started_ || dt_s > settings_.most_interval_s) {
    first_ = second_ = peak_ = valley_ = acceleration_mps2;
    started_ = rising_ = true;
    peak_time_ = time;
    return std::nullopt;
  }
  const double value = smooth(acceleration_mps2, dt_s);
  if (!rising_) {
    valley_ = std::min(valley_, value);
    if (value - valley_ > 0.5 * settings_.least_swing_mps2) {
      rising_ = true;
      peak_ = value;
      peak_time_ = time;
    }
    return std::nullopt;
  }
  if (value > peak_) {
    peak_ = value;
    peak_time_ = time;
  }
  const double swing = peak_ - valley_;
  if (peak_ - value < settings_.fall * std::clamp(swing, settings_.least_swing_mps2, 1.5 * typical_swing_)) return std::nullopt;
  rising_ = false;
  const double valley = valley_;
  valley_ = value;
  if (swing < settings_.least_swing_mps2) return std::nullopt;
  const double interval_s = walked_ ? seconds(peak_time_ - last_step_) : settings_.most_interval_s + 1.0;
  if (interval_s < std::max(settings_.least_interval_s, settings_.least_share * typical_interval_s_)) return std::nullopt;
  if (interval_s < 1.2) {
    typical_interval_s_ += 0.2 * (interval_s - typical_interval_s_);
    typical_swing_ += 0.2 * (swing - typical_swing_);
  } else {  // a new walk: forget the old one's measure
    typical_interval_s_ = settings_.least_interval_s;
    typical_swing_ = swing;
  }
  walked_ = true;
  last_step_ = peak_time_;
  return Step{peak_time_, interval_s > settings_.most_interval_s ? 0.0 : interval_s, peak_ - valley};
}

}  // namespace wayfuse
