#pragma once

#include <span>
#include <vector>

#include "tests/evaluation/walks/attacks.hpp"
#include "tests/evaluation/walks/walks_report.hpp"

namespace wayfuse {

/// Walks tracked over one map, or over several: one fold's walks are appended to another's.
struct Measured {
  std::vector<ScoredWalk> walks;
  std::vector<std::vector<Instant>> instants;  ///< parallel to walks
  std::vector<PipelineRun> runs;               ///< one a pipeline, as are all runs below
  struct Throttled {
    double every_s = 0.0;
    std::vector<PipelineRun> runs;
  };
  std::vector<Throttled> throttled;            ///< one a scan rate
  struct Attacked {
    AttackedWalks walks;                       ///< what they sensed is let go of: only places and times are asked for later
    std::vector<PipelineRun> runs;
    std::vector<PipelineRun> switched_on;      ///< kidnapped: phones that begin where these were carried to; else empty
  };
  std::vector<Attacked> attacked;              ///< one an attack
  struct Poisoned {
    PoisonRow counts;                          ///< errors of it are not filled in
    std::vector<PipelineRun> runs;
  };
  std::vector<Poisoned> poisoned;              ///< one a survey
  std::size_t maps = 1;
  std::size_t survey_walks = 0, survey_points = 0;  ///< of all maps

  ScoredData data() const { return {walks, instants}; }
  /// The same pipelines, attacks and poisons over another map. Walks of both are told apart by their ids.
  void append(Measured more);
};

/// What a phone hears whose system scans no more often: of the lists that arrived the first, and then each that comes so long after the
/// last one kept.
std::vector<ScoredWalk> throttled(std::span<const ScoredWalk> walks, double every_s);

/// `scan_rates` of an outcome.
void judge_scan_rates(const Measured& measured, std::uint64_t seed, WalksOutcome& outcome);
/// `alarms`, `attacks` and `poisons` of an outcome.
void judge_attacks(const Measured& measured, std::uint64_t seed, WalksOutcome& outcome);

}  // namespace wayfuse
