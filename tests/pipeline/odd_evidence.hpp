#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "server/pipeline/tracker.hpp"

namespace wayfuse::testing {

/// Evidence that is mostly sensible, sometimes at the edge, sometimes nonsense: NaN, infinities, huge and tiny numbers, time that
/// runs back or leaps, no readings, unknown addresses, floors climbed in one step.
MotionReport odd_motion(Random& random, PhoneTime time);
RssScan odd_scan(Random& random, PhoneTime time);
GnssFix odd_fix(Random& random, PhoneTime time);

/// Two surveyed floors, points and walks, with outlines, walls and a georeference.
std::shared_ptr<const Site> odd_site();

/// Empty = a position may be shown: it passes the check sessions make, circles in order, floor probabilities that sum to 1. Otherwise what
/// is wrong.
std::string unsound(const FusedPosition& position);

struct OddFigures {
  std::uint64_t inputs = 0;
  std::uint64_t positions = 0;   ///< published and looked at
  std::map<std::string, std::uint64_t> of_preset;  ///< those of each
  std::string fault;             ///< the first unsound one: preset, input and cause; empty = none
};
/// Feeds `inputs` odd pieces of evidence to the presets in turn, looking at the position after each. A new session begins every
/// 2,000 inputs or so, some told where they start, a copy takes over every 500. Stops at the first unsound position.
OddFigures run_odd_evidence(std::uint64_t inputs, std::uint64_t seed,
                            const std::function<void(std::uint64_t done, std::uint64_t of)>& progress = {});

}  // namespace wayfuse::testing
