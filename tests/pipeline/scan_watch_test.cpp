#include "server/pipeline/scan_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

PhoneTime at_s(double s) { return PhoneTime{from_seconds(s)}; }

RssScan scan_of(double time_s, double age_s, const std::vector<double>& levels) {
  RssScan scan{at_s(time_s), {}};
  for (std::size_t i = 0; i < levels.size(); ++i) scan.readings.push_back({Bssid{i + 1}, levels[i], from_seconds(age_s), 2412, {}, {}});
  return scan;
}

const Place kThere{{60.0, 0.0}, FloorOrdinal{0}};
const std::vector<double> kLevels = {-50, -55, -60, -61, -65, -70, -72, -75, -80, -81};

TEST(ScanWatch, ARecordingPlayedToAWalkerIsSuspect) {
  ScanWatch watch;
  for (int i = 0; i < 4; ++i) watch.hear(scan_of(2.0 * i, 0.5, kLevels), {2.5 * i, 0});
  EXPECT_TRUE(watch.suspect(at_s(6.0)));
  EXPECT_TRUE(watch.suspect(at_s(11.0)));
  EXPECT_FALSE(watch.suspect(at_s(11.1))) << "5 s after the newest copy";
}

TEST(ScanWatch, ACacheThatSaysItsAgeIsNot) {
  ScanWatch watch;
  for (int i = 0; i < 6; ++i) watch.hear(scan_of(2.0 * i, 0.5 + 2.0 * i, kLevels), {2.5 * i, 0});
  EXPECT_FALSE(watch.suspect(at_s(10.0)));
}

TEST(ScanWatch, LevelsThatStayWhileThePhoneRestsAreNot) {
  ScanWatch watch;
  for (int i = 0; i < 6; ++i) watch.hear(scan_of(2.0 * i, 0.5, kLevels), {0.01 * i, 0});
  EXPECT_FALSE(watch.suspect(at_s(10.0)));
}

TEST(ScanWatch, LevelsThatLiveAreNot) {
  ScanWatch watch;
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    auto levels = kLevels;
    for (double& level : levels) level = std::round(level + 2.0 * random.normal());
    watch.hear(scan_of(2.0 * i, 0.5, levels), {2.5 * i, 0});
    EXPECT_FALSE(watch.suspect(at_s(2.0 * i)));
  }
}

TEST(ScanWatch, TwoScansFromElsewhereAreSuspectWhereOthersAgreedWithTheTrack) {
  ScanWatch watch;
  for (int i = 0; i < 3; ++i) watch.compare(0.02, {}, at_s(i));
  watch.compare(0.3, kThere, at_s(3));
  EXPECT_FALSE(watch.suspect(at_s(3)));
  watch.compare(0.3, kThere, at_s(4));
  EXPECT_TRUE(watch.suspect(at_s(4)));
  EXPECT_TRUE(watch.elsewhere());
}

TEST(ScanWatch, ScansThatPointHereAndThereAreBadScansOnly) {
  ScanWatch watch;
  for (int i = 0; i < 3; ++i) watch.compare(0.02, {}, at_s(i));
  for (int i = 3; i < 8; ++i) watch.compare(0.3, {{60.0 * (i % 2), 0.0}, FloorOrdinal{0}}, at_s(i));
  EXPECT_FALSE(watch.suspect(at_s(8)));
  EXPECT_FALSE(watch.elsewhere());
}

TEST(ScanWatch, ATrackThatNothingEverAgreedWithAccusesNobody) {
  ScanWatch watch;
  for (int i = 0; i < 10; ++i) watch.compare(0.3, kThere, at_s(i));
  EXPECT_FALSE(watch.suspect(at_s(9)));
}

TEST(ScanWatch, StrongRadiosOutOfPlaceThreeAtOnceOrTwoTwice) {
  ScanWatch watch;
  watch.count_strong(2, at_s(0));
  EXPECT_FALSE(watch.suspect(at_s(0)));
  watch.count_strong(2, at_s(2));
  EXPECT_TRUE(watch.suspect(at_s(2)));
  ScanWatch other;
  other.count_strong(1, at_s(0));
  other.count_strong(1, at_s(1));
  EXPECT_FALSE(other.suspect(at_s(1)));
  other.count_strong(3, at_s(2));
  EXPECT_TRUE(other.suspect(at_s(2)));
}

}  // namespace
}  // namespace wayfuse
