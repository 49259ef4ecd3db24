#include "server/zones/zone_presence.hpp"

#include <gtest/gtest.h>

namespace wayfuse {
namespace {

using Change = ZonePresence::Change;
using std::chrono::seconds;

/// One phone beside one zone, a position a second.
class Beside {
 public:
  ZoneRecord zone;
  ZoneRules rules;
  ZonePresence presence;
  ServerTime now{seconds(1000)};

  /// Positions for `duration_s`, walking `speed_mps` all the time; the changes that were told.
  std::vector<Change> see(double mass, double tolerated, int duration_s, double speed_mps, BuildingPoint at = {}) {
    std::vector<Change> told;
    for (int i = 0; i < duration_s; ++i) {
      now += seconds(1);
      const auto change = presence.take({now, mass, std::max(mass, tolerated), speed_mps, {at, {0}}, 2.0}, zone, rules);
      if (change != Change::kNone) told.push_back(change);
    }
    return told;
  }
  std::vector<Change> see(double mass, int duration_s, double speed_mps) { return see(mass, mass, duration_s, speed_mps); }
  std::vector<Change> wait(int duration_s) {
    std::vector<Change> told;
    for (int i = 0; i < duration_s; ++i) {
      now += seconds(1);
      if (const auto change = presence.tick(now, zone, rules); change != Change::kNone) told.push_back(change);
    }
    return told;
  }
};

using Told = std::vector<Change>;

TEST(ZonePresence, EntersOnFootAfterTwoAndAHalfMetresOfEvidence) {
  Beside phone;
  EXPECT_EQ(phone.see(0.95, 2, 1.25), Told{});              // the first position counts from when it was seen: 1.25 m walked
  EXPECT_EQ(phone.see(0.95, 1, 1.25), Told{Change::kEntered});
}

TEST(ZonePresence, EntersAtRestAfterAMinuteOfEvidence) {
  Beside phone;
  EXPECT_EQ(phone.see(0.95, 60, 0), Told{});
  EXPECT_EQ(phone.see(0.95, 1, 0), Told{Change::kEntered});
}

TEST(ZonePresence, BeginsAnewWhenOnePositionSaysOtherwise) {
  Beside phone;
  phone.see(0.95, 59, 0);
  phone.see(0.85, 1, 0);
  EXPECT_EQ(phone.see(0.95, 60, 0), Told{});
  EXPECT_EQ(phone.see(0.95, 1, 0), Told{Change::kEntered});
}

TEST(ZonePresence, StaysBetweenTheTwoThresholds) {
  Beside phone;
  phone.see(1.0, 10, 1.3);
  EXPECT_EQ(phone.see(0.11, 600, 1.3), Told{});
  EXPECT_TRUE(phone.presence.inside());
  EXPECT_EQ(phone.see(0.10, 10, 1.3), Told{Change::kLeft});
  EXPECT_EQ(phone.see(0.89, 600, 1.3), Told{});
}

TEST(ZonePresence, ToleratesBeingJustOutsideForAWhile) {
  Beside phone;
  phone.zone.exit_tolerance_m = 3;
  phone.zone.tolerance_timeout = seconds(30);
  phone.see(1.0, 10, 1.3);
  EXPECT_EQ(phone.see(0.05, 0.8, 3, 1.3), Told{});          // believed to be outside from the third on
  EXPECT_EQ(phone.see(0.05, 0.8, 29, 1.3), Told{});
  EXPECT_EQ(phone.see(0.05, 0.8, 1, 1.3), Told{Change::kLeft});
}

TEST(ZonePresence, LeavesAtOnceBeyondItsTolerance) {
  Beside phone;
  phone.zone.exit_tolerance_m = 3;
  phone.zone.tolerance_timeout = std::nullopt;              // just outside for ever is still inside
  phone.see(1.0, 10, 1.3);
  EXPECT_EQ(phone.see(0.05, 0.8, 3600, 1.3), Told{});
  EXPECT_EQ(phone.see(0.0, 0.02, 3, 1.3), Told{Change::kLeft});
}

TEST(ZonePresence, TellsAnExitLaterAndForgetsItIfThePhoneComesBack) {
  Beside phone;
  phone.zone.exit_delay = seconds(20);
  phone.see(1.0, 10, 1.3);
  EXPECT_EQ(phone.see(0.0, 15, 1.3), Told{});
  EXPECT_EQ(phone.see(1.0, 5, 1.3), Told{});
  EXPECT_EQ(phone.see(0.0, 3, 1.3), Told{});
  EXPECT_EQ(phone.wait(19), Told{}) << "also without a further position";
  EXPECT_EQ(phone.wait(1), Told{Change::kLeft});
}

TEST(ZonePresence, NeverLeavesByWalkingUnderAnInfiniteExitDelay) {
  Beside phone;
  phone.zone.exit_delay = std::nullopt;
  phone.zone.timeout = seconds(60);
  phone.see(1.0, 10, 1.3);
  EXPECT_EQ(phone.see(0.0, 3600, 1.3), Told{});
  EXPECT_EQ(phone.wait(59), Told{});
  EXPECT_EQ(phone.wait(1), Told{Change::kLeft});
}

TEST(ZonePresence, TakesAnEntryBackWhenThePositionJumps) {
  Beside phone;
  phone.see(1.0, 1.0, 10, 1.3, {5, 5});
  EXPECT_EQ(phone.see(0.0, 0.0, 10, 1.3, {45, 5}), Told{Change::kEntryWithdrawn});
  EXPECT_FALSE(phone.presence.inside());
}

TEST(ZonePresence, TakesNothingBackFromAPhoneThatWalkedOut) {
  Beside phone;
  phone.see(1.0, 1.0, 10, 1.3, {5, 5});
  EXPECT_EQ(phone.see(0.0, 0.0, 10, 1.3, {6.2, 5}), Told{Change::kLeft});
}

TEST(ZonePresence, TakesNothingBackThatIsOlderThanAMinute) {
  Beside phone;
  phone.see(1.0, 1.0, 90, 1.3, {5, 5});
  EXPECT_EQ(phone.see(0.0, 0.0, 10, 1.3, {45, 5}), Told{Change::kLeft});
}

TEST(ZonePresence, IsForgottenOnceNothingCanBeTakenBack) {
  Beside phone;
  phone.see(1.0, 10, 1.3);
  phone.see(0.0, 3, 1.3);
  EXPECT_FALSE(phone.presence.idle());
  phone.wait(62);
  EXPECT_TRUE(phone.presence.idle());
}

}  // namespace
}  // namespace wayfuse
