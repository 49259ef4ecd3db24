#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sdk/src/recording/import/recorded_walk.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/sdk/heading_estimator.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse {

/// A true attitude from optical tracking.
struct TrueAttitude {
  PhoneTime time;                         ///< on the phone's clock
  std::optional<Quaternion> body_to_enu;  ///< absent = markers hidden
  bool counts = true;                     ///< inside the phase the data set says to score
};

/// One recording with optical truth.
struct AttitudeTrial {
  std::string name;
  std::vector<MargSample> samples;      ///< ascending in time
  std::vector<TrueAttitude> truth;      ///< ascending in time
  std::vector<RecordedAttitude> phone;  ///< the phone's own attitude where it was recorded
};

/// BROAD [Laidig et al. 2021]: one CSV a trial, sampling rate in the first line, units in the header. Sample and truth share
/// rows; time starts at 0. The data set's axes: truth turns the sensor frame into east-north-up.
Result<AttitudeTrial> read_broad_trial(const std::string& file);

enum class TyrexField : std::uint8_t { kRaw, kCalibrated };  ///< which magnetometer and gyroscope files

/// "On Attitude Estimation with Smartphones" [Michel et al.]: one folder a trial. Each sensor event is a sample of its own;
/// `timeAlignment.txt` is added to the phone's time to reach the truth's, so truth comes out on the phone's clock.
Result<AttitudeTrial> read_tyrex_trial(const std::string& folder, TyrexField field);

/// All trials of a data set's folder, ascending by name: `*.csv` files, or folders with a `truth.csv`.
std::vector<std::string> list_trials(const std::string& folder);

}  // namespace wayfuse
