#pragma once

#include <span>
#include <vector>

#include "wayfuse/proto/fix.hpp"

namespace wayfuse {

struct FloorVoteSettings {
  double memory = 0.7;             ///< b <- memory b + (1 - memory) vote
  double margin = 0.2;             ///< lead another floor needs over the present one
};

/// Floor probabilities as a running mean of the locator's votes; the floor changes only past a margin, so that it does
/// not flap. Thread: confined to one session.
class FloorVote {
 public:
  FloorVote(const FloorVoteSettings& settings, std::span<const FloorOrdinal> floors);

  bool started() const { return started_; }
  /// Certain of one floor from now on: a known start.
  void set(FloorOrdinal floor);
  void update(std::span<const FloorProbability> votes);
  FloorOrdinal floor() const { return floor_; }
  /// Descending, the present floor first; sums to 1.
  std::vector<FloorProbability> probabilities() const;

 private:
  double& belief(FloorOrdinal floor);

  FloorVoteSettings settings_;
  std::vector<FloorProbability> beliefs_;
  FloorOrdinal floor_;
  bool started_ = false;
};

}  // namespace wayfuse
