#include "tests/evaluation/walks/measured.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <optional>

namespace wayfuse {
namespace {

template <typename T>
void move_behind(std::vector<T>& all, std::vector<T>& more) {
  std::ranges::move(more, std::back_inserter(all));
}

void append_runs(std::vector<PipelineRun>& runs, std::vector<PipelineRun>& more) {
  assert(runs.size() == more.size());
  for (std::size_t r = 0; r < runs.size(); ++r) {
    move_behind(runs[r].walks, more[r].walks);
    move_behind(runs[r].first_fix_s, more[r].first_fix_s);
  }
}

bool judged(const PipelineRun& run) { return run.pipeline != "dead-reckoning"; }

}  // namespace

void Measured::append(Measured more) {
  assert(throttled.size() == more.throttled.size() && attacked.size() == more.attacked.size() && poisoned.size() == more.poisoned.size());
  move_behind(walks, more.walks);
  move_behind(instants, more.instants);
  append_runs(runs, more.runs);
  for (std::size_t t = 0; t < throttled.size(); ++t) append_runs(throttled[t].runs, more.throttled[t].runs);
  for (std::size_t a = 0; a < attacked.size(); ++a) {
    move_behind(attacked[a].walks.walks, more.attacked[a].walks.walks);
    move_behind(attacked[a].walks.instants, more.attacked[a].walks.instants);
    move_behind(attacked[a].walks.began, more.attacked[a].walks.began);
    append_runs(attacked[a].runs, more.attacked[a].runs);
    append_runs(attacked[a].switched_on, more.attacked[a].switched_on);
  }
  for (std::size_t p = 0; p < poisoned.size(); ++p) {
    poisoned[p].counts.misplaced += more.poisoned[p].counts.misplaced;
    poisoned[p].counts.doubted += more.poisoned[p].counts.doubted;
    poisoned[p].counts.doubted_rightly += more.poisoned[p].counts.doubted_rightly;
    append_runs(poisoned[p].runs, more.poisoned[p].runs);
  }
  maps += more.maps;
  survey_walks += more.survey_walks;
  survey_points += more.survey_points;
}

std::vector<ScoredWalk> throttled(std::span<const ScoredWalk> walks, double every_s) {
  std::vector<ScoredWalk> phones(walks.begin(), walks.end());
  for (ScoredWalk& phone : phones) {
    std::optional<PhoneTime> last;
    std::erase_if(phone.walk.scans, [&](const RssScan& scan) {
      if (last && seconds(scan.time - *last) < every_s) return true;
      last = scan.time;
      return false;
    });
  }
  return phones;
}

void judge_scan_rates(const Measured& measured, std::uint64_t seed, WalksOutcome& outcome) {
  for (const auto& [every_s, runs] : measured.throttled) outcome.scan_rates.push_back({every_s, score_rows(measured.data(), runs, seed)});
}

void judge_attacks(const Measured& measured, std::uint64_t seed, WalksOutcome& outcome) {
  const ScoredData honest = measured.data();
  for (const PipelineRun& run : measured.runs) outcome.alarms.push_back(count_alarms(honest, run));
  for (const auto& [every_s, runs] : measured.throttled) {
    for (const PipelineRun& run : runs) {
      outcome.alarms.push_back(count_alarms(honest, run));
      outcome.alarms.back().scan_every_s = every_s;
    }
  }
  for (const Measured::Attacked& attack : measured.attacked) {
    const bool carried = !attack.switched_on.empty();
    const ScoredData self = carried ? ScoredData{attack.walks.walks, attack.walks.instants} : honest;
    const std::vector<PipelineRun>& clean = carried ? attack.switched_on : measured.runs;
    for (std::size_t r = 0; r < attack.runs.size(); ++r) {
      if (judged(attack.runs[r])) outcome.attacks.push_back(score_attack(attack.walks, attack.runs[r], self, clean[r]));
    }
  }
  for (const Measured::Poisoned& poison : measured.poisoned) {
    for (const PipelineRun& run : poison.runs) {
      if (!judged(run)) continue;
      const ErrorSummary error = score(honest, run, Scope::kAll, nullptr, seed).error;
      PoisonRow row = poison.counts;
      row.pipeline = run.pipeline;
      row.p75_m = error.p75, row.p95_m = error.p95, row.mean_m = error.mean;
      outcome.poisons.push_back(std::move(row));
    }
  }
}

}  // namespace wayfuse
