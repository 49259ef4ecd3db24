#include <gtest/gtest.h>

#include "tests/evaluation/walks/measured.hpp"

namespace wayfuse {
namespace {

PhoneTime at(double time_s) { return PhoneTime(from_seconds(time_s)); }

/// 40 s straight on along x from (0, 0) on its floor, a scan of one radio every 2 s.
ScoredWalk walk(const std::string& id, int floor) {
  ScoredWalk scored{{}, {id}};
  scored.walk.id = id;
  scored.walk.floor = FloorOrdinal{floor};
  scored.walk.way_points = {{at(100.0), {0.0, 0.0}}, {at(140.0), {40.0, 0.0}}};
  for (int i = 0; i <= 20; ++i) {
    scored.walk.scans.push_back({at(100.0 + 2 * i), {{Bssid{7u + static_cast<unsigned>(floor)}, -50.0 - i, Duration{0}, 2437, {}, {}}}});
  }
  return scored;
}

std::vector<Instant> instants(const ScoredWalk& scored) {
  std::vector<Instant> all;
  for (const RssScan& scan : scored.walk.scans) {
    all.push_back({scan.time, {*scored.walk.truth_at(scan.time), scored.walk.floor}, true, seconds(scan.time - at(100.0))});
  }
  return all;
}

/// Answers `off_m` beside the truth, `suspect` from 110 s on where asked for.
PipelineRun run_over(const std::vector<std::vector<Instant>>& asked, double off_m, bool suspect) {
  PipelineRun run{"default", "direct", {}, std::vector<std::optional<double>>(asked.size())};
  for (const auto& instants : asked) {
    Answers answers;
    for (const Instant& instant : instants) {
      FusedPosition position;
      position.place = instant.truth;
      position.place.point.y_m += off_m;
      position.integrity = suspect && instant.time >= at(110.0) ? Integrity::kSuspect : Integrity::kOk;
      answers.emplace_back(position);
    }
    run.walks.push_back(std::move(answers));
  }
  return run;
}

TEST(Attacks, WhoIsCarriedOffAndWhoIsSwitchedOnThereHearAndAreAskedTheSame) {
  const std::vector<ScoredWalk> walks = {walk("a", 0), walk("b", 1)};
  const std::vector<std::vector<Instant>> asked = {instants(walks[0]), instants(walks[1])};
  for (const bool mid : {false, true}) {
    const AttackedWalks attacked = kidnapped({walks, asked}, mid);
    const std::vector<ScoredWalk> there = switched_on(attacked);
    ASSERT_EQ(attacked.walks.size(), 2u);
    ASSERT_EQ(there.size(), 2u);
    for (std::size_t w = 0; w < 2; ++w) {
      const std::vector<RssScan>& carried = attacked.walks[w].walk.scans;
      const std::vector<RssScan>& fresh = there[w].walk.scans;
      EXPECT_EQ(carried.front().readings[0].bssid, Bssid{8u - w}) << "at first it is on the other walk";
      ASSERT_EQ(fresh.size(), mid ? 11u : 21u);
      EXPECT_EQ(fresh.front().readings[0].bssid, Bssid{7u + w});
      EXPECT_EQ(fresh.front().time, *attacked.began[w]);
      EXPECT_EQ(fresh.back().time, carried.back().time);
      EXPECT_EQ(attacked.instants[w].size(), fresh.size());
      EXPECT_EQ(there[w].walk.id, walks[w].walk.id);
    }
  }
}

Measured fold(const std::string& id, double off_m, bool suspect) {
  Measured fold;
  fold.walks = {walk(id, 0)};
  fold.instants = {instants(fold.walks[0])};
  fold.runs = {run_over(fold.instants, 1.0, false)};
  fold.throttled = {{30.0, {run_over(fold.instants, 2.0 * off_m, false)}}};
  fold.attacked.push_back({{"fakes", "elsewhere", 3, 0.0, fold.walks, fold.instants, {at(108.0)}}, {run_over(fold.instants, off_m, suspect)}, {}});
  auto arrived = fold.instants;
  for (Instant& instant : arrived[0]) instant.covered = id == "b";
  fold.attacked.push_back({{"kidnap", "start", 0, 30.0, fold.walks, arrived, {at(102.0)}}, {run_over(fold.instants, off_m, suspect)},
                           {run_over(fold.instants, 3.0, false)}});
  fold.poisoned.push_back({{{}, 0.05, 0.0, true, 5, 4, 3}, {run_over(fold.instants, off_m, false)}});
  fold.survey_walks = 10;
  return fold;
}

TEST(Attacks, FoldsAreJudgedTogether) {
  Measured all = fold("a", 2.0, true);
  all.append(fold("b", 12.0, false));
  EXPECT_EQ(all.maps, 2u);
  EXPECT_EQ(all.survey_walks, 20u);
  WalksOutcome outcome;
  judge_scan_rates(all, 1, outcome);
  ASSERT_EQ(outcome.scan_rates.size(), 1u);
  EXPECT_DOUBLE_EQ(outcome.scan_rates[0].every_s, 30.0);
  ASSERT_EQ(outcome.scan_rates[0].rows.size(), 2u) << "ALL and COV";
  EXPECT_DOUBLE_EQ(outcome.scan_rates[0].rows[0].error.mean, 14.0) << "4 m on one, 24 m on the other";
  judge_attacks(all, 1, outcome);
  ASSERT_EQ(outcome.alarms.size(), 2u);
  EXPECT_DOUBLE_EQ(outcome.alarms[0].scan_every_s, 0.0);
  EXPECT_DOUBLE_EQ(outcome.alarms[1].scan_every_s, 30.0) << "throttled phones raise alarms, too";
  EXPECT_NEAR(outcome.alarms[0].hours, 80.0 / 3600.0, 1e-9);
  EXPECT_EQ(outcome.alarms[0].alarms, 0u);
  ASSERT_EQ(outcome.attacks.size(), 2u);
  const AttackRow& fakes = outcome.attacks[0];
  EXPECT_EQ(fakes.walks, 2u);
  EXPECT_DOUBLE_EQ(fakes.flagged, 0.5) << "one of two walks";
  EXPECT_DOUBLE_EQ(fakes.clean_p95_m, 1.0) << "the same walks, unattacked";
  const AttackRow& carried = outcome.attacks[1];
  EXPECT_DOUBLE_EQ(carried.scan_every_s, 30.0);
  EXPECT_EQ(carried.carried[0].walks, 2u);
  EXPECT_DOUBLE_EQ(carried.carried[0].within10, 0.5);
  EXPECT_DOUBLE_EQ(carried.switched_on[0].within10, 1.0);
  EXPECT_DOUBLE_EQ(carried.switched_on[0].p95_m, 3.0);
  EXPECT_EQ(carried.carried[1].walks, 1u) << "the other one is off the survey by then";
  EXPECT_DOUBLE_EQ(carried.carried[1].within10, 0.0);
  ASSERT_EQ(outcome.poisons.size(), 1u);
  EXPECT_EQ(outcome.poisons[0].misplaced, 10u);
  EXPECT_EQ(outcome.poisons[0].doubted_rightly, 6u);
  EXPECT_DOUBLE_EQ(outcome.poisons[0].mean_m, 7.0) << "2 m on one, 12 m on the other";
}

}  // namespace
}  // namespace wayfuse
