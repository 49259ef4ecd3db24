#include <gtest/gtest.h>

#include "wayfuse/sdk/scan_planner.hpp"

namespace wayfuse {
namespace {

using namespace std::chrono_literals;

PhoneTime at_s(double time_s) { return PhoneTime{from_seconds(time_s)}; }

/// Follows the advice for ten minutes; returns when scans began.
std::vector<PhoneTime> follow(ScanPlanner& planner, bool at_rest = false) {
  std::vector<PhoneTime> scans;
  for (double t = 1000; t < 1600; t += 0.5) {
    planner.moved(at_rest, at_s(t));
    const ScanAdvice advice = planner.advise(at_s(t));
    if (advice.at && *advice.at <= at_s(t)) {
      planner.started(at_s(t));
      scans.push_back(at_s(t));
    }
  }
  return scans;
}

TEST(ScanPlanner, NeverAsksAndroidForAFifthScanInTwoMinutes) {
  for (const Duration wish : {Duration{1s}, Duration{10s}, Duration{30s}}) {
    ScanPlanner planner(ScanPlatform::kAndroidForeground);
    planner.hinted(ScanHint{wish, false, ""});
    const auto scans = follow(planner);
    EXPECT_GE(scans.size(), 18u);
    for (std::size_t i = 4; i < scans.size(); ++i) EXPECT_GT(scans[i] - scans[i - 4], 120s);
  }
}

TEST(ScanPlanner, SpreadsScansEvenlyWithoutAWish) {
  ScanPlanner planner(ScanPlatform::kAndroidForeground);
  const auto scans = follow(planner);
  ASSERT_GE(scans.size(), 19u);
  for (std::size_t i = 1; i < scans.size(); ++i) EXPECT_GE(scans[i] - scans[i - 1], 30s);
}

TEST(ScanPlanner, AsksSeldomAtRest) {
  ScanPlanner planner(ScanPlatform::kAndroidForeground);
  EXPECT_LE(follow(planner, true).size(), 6u);
}

TEST(ScanPlanner, AsksOnceInHalfAnHourInTheBackground) {
  ScanPlanner planner(ScanPlatform::kAndroidBackground);
  planner.hinted(ScanHint{10s, false, ""});
  EXPECT_EQ(follow(planner).size(), 1u);
}

TEST(ScanPlanner, FollowsTheServerWhereNothingForbids) {
  ScanPlanner planner(ScanPlatform::kUnlimited);
  planner.hinted(ScanHint{10s, false, ""});
  EXPECT_EQ(follow(planner).size(), 60u);
  planner.hinted(ScanHint{0s, false, ""});
  EXPECT_FALSE(planner.advise(at_s(2000)).at);
  planner.forget_hint();
  EXPECT_TRUE(planner.advise(at_s(2000)).at);
}

TEST(ScanPlanner, SaysThatIosHasNoScans) {
  ScanPlanner planner(ScanPlatform::kIos);
  const ScanAdvice advice = planner.advise(at_s(1));
  EXPECT_FALSE(advice.possible);
  EXPECT_FALSE(advice.at);
  EXPECT_NE(advice.why.find("iOS"), std::string_view::npos);
}

}  // namespace
}  // namespace wayfuse
