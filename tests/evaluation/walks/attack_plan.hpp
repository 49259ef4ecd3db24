#pragma once

#include <string>
#include <vector>

#include "tests/evaluation/walks/attacks.hpp"

namespace CLI {
class App;
}

namespace wayfuse {

/// What `wayfuse-eval walks` is asked to do to the walks, besides replaying them.
struct AttackPlan {
  std::vector<int> fakes;
  std::vector<std::string> fake_kinds = {"unknown", "elsewhere", "floor"};
  double fake_dbm = -35.0;
  double attack_from_s = 8.0;
  bool replay = false;
  std::vector<std::string> kidnap;
  double poison = 0.0;         ///< share of the survey's points
  double poison_walks = 0.0;   ///< share of the survey's walks
  bool poisons() const { return poison > 0.0 || poison_walks > 0.0; }
};

void add_attack_options(CLI::App& command, AttackPlan& plan);
/// All attacks asked for but the poisoned survey, which needs maps of its own.
std::vector<AttackedWalks> attacks_of(const AttackPlan& plan, const ScoredData& data, std::span<const RecordedWalk> survey);

}  // namespace wayfuse
