#pragma once

#include "sdk/src/walking/step_detector.hpp"
#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// Weinberg's step length K (a_max - a_min)^(1/4) [P2, P3 eq. 8], metres, kept within 0.2..1.3 m.
double weinberg_step_length_m(double swing_mps2, double k = 0.5);

struct StepLengthSettings {
  // Weinberg, its square root's bend, a constant and the cadence; fitted to walks of many people, see README.
  double weinberg_m = 2.01, constant_m = -1.56, per_hertz_m = -0.21, per_swing_m = -0.085;
  double swing_most_mps2 = 9.0;      ///< beyond it the model is flat
  double least_m = 0.3, most_m = 1.2;
  double relative_sigma = 0.10;      ///< of a walker not known yet: standard deviation of the scale
  double relative_sigma_step = 0.08; ///< of a single step around the walker's mean
  double teach_m = 12.0;             ///< displacement between two fused positions that teaches
  double straight = 0.9;             ///< displacement over path length at and above which it does
};

/// How long a step is, for this walker: a general model times a scale learnt from fused positions coming back.
///
/// A plain struct; keep `scale` and `scale_sigma` when the application ends.
struct StepLength {
  double scale = 1.0;
  double scale_sigma = 0.10;
  double cadence_hz = 0.0;          ///< running mean; 0 = none yet

  /// The length of a step; keeps the cadence.
  double take(const StepLengthSettings& settings, const Step& step);
  /// Adds a step's displacement (metres, any level frame that holds over tens of seconds) to what is compared.
  void walked(double length_m, double dx_m, double dy_m);
  /// A fused position; `sigma_m` per axis. Over a straight stretch the two displacements teach the scale.
  void taught(const StepLengthSettings& settings, BuildingPoint fused, double sigma_m);

 private:
  BuildingPoint anchor_;
  double anchor_sigma_m_ = 0.0;
  bool anchored_ = false;
  double path_m_ = 0.0, dx_m_ = 0.0, dy_m_ = 0.0;
};

}  // namespace wayfuse
