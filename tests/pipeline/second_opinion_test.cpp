#include "server/pipeline/second_opinion.hpp"

#include <gtest/gtest.h>

#include "tests/pipeline/beacon.hpp"

namespace wayfuse {
namespace {

constexpr double kEcho = 0.67;  // scans every 2 s

class SecondOpinionAbout : public testing::Test {
 protected:
  SecondOpinionAbout() : track_(WalkerSettings{}) {
    second_.begin(WalkerSettings{}, there_, FloorOrdinal{0}, nullptr, {}, {}, random_);
    track_.start_about({-60.0, 0.0}, 3.0, {}, random_);
  }
  bool hear(double log_evidence, bool contradicted = true, BuildingPoint mean = {-60.0, 0.0}) {
    return second_.hear(there_, {log_evidence, contradicted, mean, FloorOrdinal{0}}, {}, kEcho, {}, random_);
  }
  Beacon there_{{40.0, 0.0}};
  Random random_{1};
  SecondOpinion second_;
  WalkerCloud track_;
};

TEST_F(SecondOpinionAbout, ATrackThatForetellsNothingLosesItsPlace) {
  ASSERT_TRUE(second_.begun());
  EXPECT_TRUE(hear(-30.0));
  FloorOrdinal floor{3};
  second_.change_places(track_, floor);
  EXPECT_LT(distance_m(track_.spread().mean, {40.0, 0.0}), 2.0);
  EXPECT_EQ(floor, FloorOrdinal{0});
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(hear(-1.0, false, {40.0, 0.0}));
  EXPECT_FALSE(second_.begun()) << "who lost foretells nothing either";
}

TEST_F(SecondOpinionAbout, WhoLostByScansThatErredAlikeTakesTheVerdictBack) {
  ASSERT_TRUE(hear(-30.0));
  FloorOrdinal floor{0};
  second_.change_places(track_, floor);
  ASSERT_TRUE(second_.begun());
  Beacon here({-60.0, 0.0});  // the scans are themselves again, and agree with who they took for the track
  EXPECT_TRUE(second_.hear(here, {-30.0, false, {40.0, 0.0}, FloorOrdinal{0}}, {}, kEcho, {}, random_));
  second_.change_places(track_, floor);
  EXPECT_LT(distance_m(track_.spread().mean, {-60.0, 0.0}), 3.0);
}

TEST_F(SecondOpinionAbout, ATrackALittleWorseTakesSeveralScans) {
  int scans = 1;
  while (second_.begun() && !hear(-4.0)) ++scans;
  EXPECT_GE(scans, 2);
  EXPECT_LE(scans, 4);
}

TEST_F(SecondOpinionAbout, ATrackThatForetellsAsWellKeepsItsPlace) {
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(hear(-0.6));
  EXPECT_FALSE(second_.begun()) << "undecided for long: dropped";
}

TEST_F(SecondOpinionAbout, ScansThatDoNotContradictTheTrackSpeakForNobodyElse) {
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(hear(-30.0, false));
}

TEST_F(SecondOpinionAbout, OneThatCameToTheSamePlaceIsNone) {
  EXPECT_FALSE(hear(-4.0, true, {42.0, 0.0}));
  EXPECT_FALSE(second_.begun());
}

TEST(SecondOpinion, MoreIsAskedOfScansFromUnsurveyedGround) {
  EXPECT_TRUE(SecondOpinion::contradicts(0.1, 1.0));
  EXPECT_FALSE(SecondOpinion::contradicts(0.1, 2.0));
  EXPECT_TRUE(SecondOpinion::contradicts(0.3, 2.0));
  EXPECT_FALSE(SecondOpinion::contradicts(0.9, 3.0));
}

}  // namespace
}  // namespace wayfuse
