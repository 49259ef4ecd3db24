#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/quality/metrics.hpp"
#include "tests/evaluation/walks/selection.hpp"
#include "tests/evaluation/walks/survey_cover.hpp"
#include "wayfuse/proto/fix.hpp"

namespace wayfuse {

/// A moment at which an estimate is asked for: a scan's arrival or a way point, between the first way point and the last.
struct Instant {
  PhoneTime time;
  Place truth;
  bool covered = false;        ///< the survey came by within 3 m
  double since_start_s = 0.0;  ///< from the first way point
};
std::vector<Instant> instants_of(const RecordedWalk& walk, const SurveyCover& cover);

/// What a pipeline answered on one walk: one entry an instant.
using Answers = std::vector<std::optional<FusedPosition>>;

/// A pipeline's run over all scored walks, in their order.
struct PipelineRun {
  std::string pipeline;
  std::string path;  ///< how the data went: `session`, `socket` or `direct`
  std::vector<Answers> walks;
  std::vector<std::optional<double>> first_fix_s;  ///< from the beginning of each walk
};

enum class Scope : std::uint8_t { kAll, kCovered };
std::string_view name_of(Scope scope);  ///< `ALL`, `COV`

/// Error figures of one pipeline in one scope, over all floors or one.
struct ScoreRow {
  std::string pipeline;
  std::string path;
  Scope scope = Scope::kAll;
  std::string floor;  ///< label; empty = all floors
  std::size_t walks = 0;
  std::size_t asked = 0;   ///< instants in the scope
  ErrorSummary error;      ///< horizontal, over the instants that were answered
  Interval mean_interval;  ///< 95 %, bootstrap over walks, as are the next
  Interval median_interval;
  double floor_hit = 0.0;  ///< share of the answers on the right floor
  Interval floor_hit_interval;
  double ttff_s = 0.0;  ///< median time to first fix
  double in68 = 0.0;    ///< share of the answers whose stated circle holds the truth
  double in95 = 0.0;
  Interval in68_interval;
  Interval in95_interval;
  std::optional<double> radius_rank_corr;  ///< of the stated 68 % radius with the error
};

struct ScoredData {
  std::span<const ScoredWalk> walks;
  std::span<const std::vector<Instant>> instants;  ///< parallel to walks
};

/// `floor` null = all.
ScoreRow score(const ScoredData& data, const PipelineRun& run, Scope scope, const Floor* floor, std::uint64_t seed);

/// Per walk sums of the error in a scope, for paired comparison and per-walk tables.
std::vector<GroupSum> error_sums(const ScoredData& data, const PipelineRun& run, Scope scope);
/// Errors of all answers in a scope, in order.
std::vector<double> errors_in(const ScoredData& data, const PipelineRun& run, Scope scope);

/// Mean error by seconds since the walk's start: 0-10, 10-30, 30-60, 60-120, beyond.
struct TimeBin {
  double from_s = 0.0;
  double to_s = 0.0;
  std::size_t n = 0;
  double mean_m = 0.0;
  Interval interval;
};
std::vector<TimeBin> score_by_time(const ScoredData& data, const PipelineRun& run, Scope scope, std::uint64_t seed);

}  // namespace wayfuse
