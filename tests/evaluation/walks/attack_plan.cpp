#include "tests/evaluation/walks/attack_plan.hpp"

#include <CLI/CLI.hpp>

namespace wayfuse {

void add_attack_options(CLI::App& command, AttackPlan& plan) {
  command.add_option("--fakes", plan.fakes, "Attack: so many loud rogue access points in every scan (comma separated counts)")
      ->delimiter(',')
      ->check(CLI::Range(1, 64));
  command
      .add_option("--fake-kinds", plan.fake_kinds,
                  "Their addresses: unknown to the survey, copied elsewhere on the floor, copied on another floor")
      ->delimiter(',')
      ->check(CLI::IsMember({"unknown", "elsewhere", "floor"}))
      ->capture_default_str();
  command.add_option("--fake-dbm", plan.fake_dbm, "How loud they are at the phone")->check(CLI::Range(-100.0, 0.0))->capture_default_str();
  command.add_option("--attack-from", plan.attack_from_s, "Seconds from a walk's first way point to the attack")->capture_default_str();
  command.add_flag("--replay-attack", plan.replay, "Attack: the scans of another walk elsewhere, one for ever (frozen) and all of them (live)");
  command
      .add_option("--kidnap", plan.kidnap, "A tracked phone finds itself elsewhere: at another walk's start, or mid-walk")
      ->delimiter(',')
      ->check(CLI::IsMember({"start", "mid"}));
  command.add_option("--poison", plan.poison, "Share of the survey's points uploaded with a wrong place")->check(CLI::Range(0.0, 1.0));
  command.add_option("--poison-walks", plan.poison_walks, "Share of the survey's walks uploaded 30 m out of place")->check(CLI::Range(0.0, 1.0));
}

std::vector<AttackedWalks> attacks_of(const AttackPlan& plan, const ScoredData& data, std::span<const RecordedWalk> survey) {
  std::vector<AttackedWalks> all;
  for (const FakeKind kind : {FakeKind::kUnknown, FakeKind::kElsewhere, FakeKind::kFloor}) {
    if (std::ranges::find(plan.fake_kinds, name_of(kind)) == plan.fake_kinds.end()) continue;
    for (const int count : plan.fakes) all.push_back(with_fakes(data, survey, {count, kind, plan.attack_from_s, plan.fake_dbm}));
  }
  if (plan.replay) {
    for (const bool live : {false, true}) all.push_back(with_replay(data, live, plan.attack_from_s));
  }
  for (const std::string& moment : plan.kidnap) all.push_back(kidnapped(data, moment == "mid"));
  return all;
}

}  // namespace wayfuse
