#pragma once

#include <string>
#include <vector>

#include "admin/session_control.hpp"
#include "server/buildings/building_shelf.hpp"

namespace wayfuse {

/// What a session knows about its newest position, taken out of its tracker in one moment.
struct PositionGrounds {
  FusedPosition position;
  RssScan scan;                             ///< the newest one fed
  std::vector<std::string> left_out;        ///< one a reading of the scan; empty = it reached the locator
  std::vector<std::string> doubts;
  std::vector<WeightedPlace> particles;
};
PositionGrounds grounds_of(const Tracker& tracker, FusedPosition position, RssScan newest, std::size_t most_particles = 500);

/// Holds the grounds against the survey, whatever the pipeline was: each reading against its mean level in the scans of the
/// nearest surveyed points on the floor. Cost: one pass over the survey's points; no tracker is touched.
Explanation explain(const Building& building, PositionGrounds grounds);

}  // namespace wayfuse
