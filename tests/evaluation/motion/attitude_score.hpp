#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sdk/src/recording/import/attitude_trial.hpp"
#include "wayfuse/sdk/heading_estimator.hpp"

namespace wayfuse {

/// Errors of an attitude, degrees: the whole rotation, its part about the vertical, and the rest.
struct AttitudeError {
  double total_deg = 0.0, heading_deg = 0.0, inclination_deg = 0.0;
};
AttitudeError attitude_error(Quaternion truth, Quaternion estimate);

/// How an estimator is run over a trial.
struct TrialRun {
  bool skip_rest = false;              ///< begin where the scored phase begins
  int every = 1;                       ///< feed every n-th sample only
  std::optional<MagneticField> expected;
};

/// One estimator on one trial: root mean squares over the scored truth.
struct TrialScore {
  std::string estimator;
  std::string trial;
  AttitudeError rmse;
  double median_deg = 0.0;             ///< of the total error
  double ns_per_sample = 0.0;          ///< of feed(), the fastest of three passes
  double in_sigma = 0.0, in_two_sigma = 0.0;  ///< share of heading errors within the stated sigma, and twice it
  std::vector<double> totals_deg;      ///< of every instant scored
};

struct NamedEstimator {
  std::string name;
  std::function<std::unique_ptr<HeadingEstimator>()> make;
};
/// The catalogue's, block_marg without its sensor delay, and the Madgwick baseline.
std::vector<NamedEstimator> measured_estimators();

TrialScore score(const NamedEstimator& estimator, const AttitudeTrial& trial, const TrialRun& run);
/// The attitude the phone's own system recorded; magnetic axes are turned by the declination.
TrialScore score_phone(const AttitudeTrial& trial, const TrialRun& run);

}  // namespace wayfuse
