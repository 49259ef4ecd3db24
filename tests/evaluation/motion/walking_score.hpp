#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sdk/src/recording/import/recorded_walk.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse {

/// Steps counted by one detector over one recording.
struct StepCount {
  std::string detector;
  int steps = 0;
};
/// The tracker's own count, and [P2]'s bare peaks beside it.
std::vector<StepCount> count_steps(const std::vector<MargSample>& samples);

/// One stretch between two way points, as the phone reckoned it.
struct Stretch {
  double true_m = 0.0;
  double true_rad = 0.0;      ///< direction, from the x axis
  double dx_m = 0.0, dy_m = 0.0;  ///< sum of the reported steps
};
/// A walk through a MotionTracker, cut at its way points.
struct ReckonedWalk {
  double true_m = 0.0;        ///< along the way points
  double reckoned_m = 0.0;    ///< sum of the step lengths between the first and the last
  int steps = 0;
  std::vector<Stretch> stretches;
};
ReckonedWalk reckon(const RecordedWalk& walk, const std::string& heading_estimator);

/// Direction errors of all stretches at least `least_m` long, degrees. Relative: the walk's own mean error taken out (walks
/// with two stretches or more).
struct DirectionErrors {
  std::vector<double> absolute_deg, relative_deg;
};
DirectionErrors direction_errors(const std::vector<ReckonedWalk>& walks, double least_m);

/// The p-quantile (0..1) of the values; 0 if there are none.
double quantile(std::vector<double> values, double p);

}  // namespace wayfuse
