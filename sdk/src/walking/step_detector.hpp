#pragma once

#include <optional>

#include "wayfuse/proto/time.hpp"

namespace wayfuse {

struct StepDetectorSettings {
  double cutoff_hz = 3.0;              ///< low-pass on |a|; larger follows sharper impacts and counts more shakes
  double least_swing_mps2 = 1.3;       ///< peak minus valley of a step; larger misses soft steps, smaller counts fidgeting
  double fall = 0.5;                   ///< share of the swing the signal must fall from a peak to end it
  double least_interval_s = 0.25;      ///< [P2]: window 0.2..2 s
  double least_share = 0.5;            ///< and no less than this share of the walker's usual interval: bounces are not steps
  double most_interval_s = 2.0;        ///< a step later than this begins a new walk
};

/// One step, as it was recognised.
struct Step {
  PhoneTime time;            ///< of the acceleration's peak
  double interval_s = 0.0;   ///< since the step before it; 0 = first of a walk
  double swing_mps2 = 0.0;   ///< a_max - a_min of the step, for the stride model
};

/// Peaks and valleys of the total acceleration [P2]: a step is a peak that rises enough above the valley before it and falls
/// enough below it again, within the time window.
///
/// Causal: a step comes out as soon as the fall after its peak has reached half the swing. A plain struct of state; thread:
/// confined to its owner.
class StepDetector {
 public:
  explicit StepDetector(const StepDetectorSettings& settings = {}) : settings_(settings) {}

  /// `acceleration_mps2` is |a|; times strictly ascending.
  std::optional<Step> feed(PhoneTime time, double acceleration_mps2);

 private:
  double smooth(double value, double dt_s);

  StepDetectorSettings settings_;
  double first_ = 0.0, second_ = 0.0;     // two poles of the low-pass
  double peak_ = 0.0, valley_ = 0.0;
  double typical_swing_ = 3.0, typical_interval_s_ = 0.25;
  PhoneTime time_, peak_time_, last_step_;
  bool started_ = false, rising_ = true, walked_ = false;
};

}  // namespace wayfuse
