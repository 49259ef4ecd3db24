#pragma once

#include <string>
#include <vector>

#include "tests/evaluation/datasets/recorded_site.hpp"
#include "tests/evaluation/walks/attacks.hpp"
#include "tests/evaluation/walks/walk_score.hpp"

namespace wayfuse {

/// Everything a run of `wayfuse-eval walks` found out.
struct WalksOutcome {
  std::string data;
  std::string split;  ///< `test`, `dev` or `only`
  bool chain = false;
  double rss_offset_db = 0.0;
  std::uint64_t seed = 0;
  std::size_t survey_walks = 0;
  std::size_t survey_points = 0;
  std::vector<ScoreRow> rows;        ///< a pipeline and scope, all floors
  std::vector<ScoreRow> floor_rows;  ///< the same by floor
  struct AtScanRate {
    double every_s = 0.0;            ///< one scan in so long was heard
    std::vector<ScoreRow> rows;
  };
  std::vector<AtScanRate> scan_rates;  ///< asked for by --scan-every
  struct ByTime {
    std::string pipeline;
    Scope scope;
    std::vector<TimeBin> bins;
  };
  std::vector<ByTime> by_time;
  struct Pair {
    std::string pipeline;  ///< compared with `against`: negative = better
    std::string against;
    Scope scope;
    PairedDifference mean;
  };
  std::vector<Pair> pairs;
  std::vector<AlarmRow> alarms;      ///< a pipeline, on honest walks
  std::vector<AttackRow> attacks;    ///< asked for by --fakes, --replay-attack, --kidnap
  std::vector<PoisonRow> poisons;    ///< asked for by --poison, --poison-walks
};

WalksOutcome summarise_walks(const ScoredData& data, const std::vector<PipelineRun>& runs, const RecordedSite& site,
                             std::uint64_t seed);

/// A pipeline and scope each, all floors.
std::vector<ScoreRow> score_rows(const ScoredData& data, const std::vector<PipelineRun>& runs, std::uint64_t seed);

std::string walks_json(const WalksOutcome& outcome);
/// `alarms`, `attacks` and `poisons` of the JSON; empty lists are left out.
std::string attacks_json(const WalksOutcome& outcome);
/// The same for a terminal and, as Markdown, for the report.
std::string attacks_table(const WalksOutcome& outcome);
/// The table people read on a terminal.
std::string walks_table(const WalksOutcome& outcome);
/// report.md, walks.csv and the pictures, into a folder that is made if need be; no pictures of the coverage without one `cover` of
/// all walks. Throws std::runtime_error if it cannot be written.
void write_walks_report(const std::string& folder, const WalksOutcome& outcome, const ScoredData& data,
                        const std::vector<PipelineRun>& runs, const RecordedSite& site, const SurveyCover* cover);

}  // namespace wayfuse
