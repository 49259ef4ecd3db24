#pragma once

#include <optional>

#include "wayfuse/sdk/marg.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

namespace wayfuse {

/// Changes of height from the barometer, and whether they are stairs (steps go with them) or a lift. A plain struct.
struct Climb {
  void feed(const MargSample& sample, bool walking);
  /// Metres since the last call; absent without a barometer.
  std::optional<double> take();
  /// Metres above where it was first heard, smoothed over a second; absent without a barometer.
  std::optional<double> above_m() const { return started_ ? std::optional(smooth_m_) : std::nullopt; }
  Climbing climbing() const;

 private:
  double smooth_m_ = 0.0, taken_m_ = 0.0, rate_mps_ = 0.0;
  double walking_share_ = 0.0;   // of the recent time
  PhoneTime time_;
  bool started_ = false;
};

}  // namespace wayfuse
