#pragma once

#include <string>
#include <vector>

#include "wayfuse/proto/result.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse {

/// A walk with a foot switch: how many steps were really made.
struct StepTrial {
  std::string name;
  std::vector<MargSample> samples;  ///< accelerometer only
  std::vector<int> true_steps;      ///< so far, one a sample
  std::vector<int> hardware_steps;  ///< so far, by the phone's own step counter
};

/// Oxford step counter: `ns, ax, ay, az, steps by their app, true steps, hardware steps`, no header.
Result<StepTrial> read_oxford_trial(const std::string& file);

}  // namespace wayfuse
