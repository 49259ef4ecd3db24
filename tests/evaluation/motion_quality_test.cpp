#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "sdk/src/recording/import/step_trial.hpp"
#include "tests/evaluation/motion/attitude_score.hpp"
#include "tests/evaluation/motion/walking_score.hpp"

// The motion core on real recordings: wide bounds, so that a change that breaks it is seen before anybody runs the evaluation.
namespace wayfuse {
namespace {

namespace fs = std::filesystem;

fs::path data(const char* set) {
  const char* root = std::getenv("WAYFUSE_DATA");
  return root ? fs::path(root) / set : fs::path();
}

NamedEstimator named(const std::string& name) {
  for (const NamedEstimator& estimator : measured_estimators()) {
    if (estimator.name == name) return estimator;
  }
  throw std::runtime_error(name);
}

TEST(MotionQuality, AttitudeStaysAheadOfTheBaselineOnRealTrials) {
  const fs::path folder = data("broad");
  if (!fs::exists(folder)) GTEST_SKIP() << "SKIPPED: WAYFUSE_DATA is not set or holds no broad: nothing was measured";
  double ours_deg = 0.0, baseline_deg = 0.0;
  int trials = 0;
  for (const std::string& path : list_trials(folder.string())) {
    if (trials == 4) break;  // minutes matter
    const auto trial = read_broad_trial(path);
    ASSERT_TRUE(trial) << to_string(trial.fault());
    ours_deg += score(named("block_marg"), *trial, {}).rmse.total_deg;
    baseline_deg += score(named("madgwick_baseline"), *trial, {}).rmse.total_deg;
    ++trials;
  }
  ASSERT_GT(trials, 0);
  EXPECT_LT(ours_deg / trials, 2.6);
  EXPECT_LT(ours_deg, 0.7 * baseline_deg);
}

TEST(MotionQuality, StepsOfRealWalksAreCountedAndWavedHandsAreNot) {
  const fs::path folder = data("oxford-steps");
  if (!fs::exists(folder)) GTEST_SKIP() << "SKIPPED: WAYFUSE_DATA is not set or holds no oxford-steps: nothing was measured";
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".csv") continue;
    const auto trial = read_oxford_trial(entry.path().string());
    ASSERT_TRUE(trial) << to_string(trial.fault());
    const int truth = trial->true_steps.back();
    EXPECT_NEAR(count_steps(trial->samples).front().steps, truth, 0.02 * truth) << trial->name;
  }
  const fs::path still = data("broad");
  if (!fs::exists(still)) return;
  const auto trials = list_trials(still.string());
  const auto trial = read_broad_trial(trials.front());
  ASSERT_TRUE(trial);
  const double minutes = seconds(trial->samples.back().time - trial->samples.front().time) / 60.0;
  EXPECT_LT(count_steps(trial->samples).front().steps / minutes, 6.0);
}

}  // namespace
}  // namespace wayfuse
