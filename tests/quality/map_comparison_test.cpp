#include "server/quality/map_comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace wayfuse {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

/// A walk of 100 instants with this mean error; every error the same, all circles as honest as said.
MapQuality walk(std::uint64_t id, double mean_m, double floor_hit = 1.0, double in95 = 0.95) {
  MapQuality quality;
  quality.walk_id = id;
  quality.asked = quality.instants = 100;
  quality.mean_m = mean_m;
  quality.floor_hit = floor_hit;
  quality.in68 = 0.68;
  quality.in95 = in95;
  quality.error_quantiles_m = std::vector<float>(101, static_cast<float>(mean_m));
  return quality;
}

std::vector<MapQuality> walks(std::initializer_list<double> means_m, double floor_hit = 1.0, double in95 = 0.95) {
  std::vector<MapQuality> found;
  for (const double mean_m : means_m) found.push_back(walk(found.size() + 1, mean_m, floor_hit, in95));
  return found;
}

TEST(MapComparison, SmallDifferencesAreNoise) {
  const auto comparison = compare(walks({3.0, 4.1, 5.0, 2.1}), walks({3.1, 4.0, 4.9, 2.0}));
  EXPECT_EQ(comparison.verdict, Verdict::kSame);
  EXPECT_EQ(compare(walks({2.97, 3.97, 4.97}), walks({3.0, 4.0, 5.0})).verdict, Verdict::kSame) << "3 cm on every walk are still 3 cm";
  EXPECT_NEAR(comparison.mean_m.difference, 0.05, 1e-9);  // (-0.1 + 0.1 + 0.1 + 0.1) / 4
  EXPECT_FALSE(comparison.reasons.empty());
}

TEST(MapComparison, WorseOnEveryWalkIsWorse) {
  const auto comparison = compare(walks({3.5, 4.6, 5.4, 2.6}), walks({3.0, 4.0, 5.0, 2.0}));
  EXPECT_EQ(comparison.verdict, Verdict::kWorse);
  EXPECT_THAT(comparison.reasons, Contains(HasSubstr("mean error rises from 3.50 to 4.03 m")));
  EXPECT_EQ(compare(walks({3.0, 4.0, 5.0, 2.0}), walks({3.5, 4.6, 5.4, 2.6})).verdict, Verdict::kBetter);
}

TEST(MapComparison, OneWalkMuchWorseIsWorseAlthoughThereIsNoIntervalToSpeakOf) {
  EXPECT_EQ(compare(walks({4.0}), walks({3.0})).verdict, Verdict::kWorse);
  EXPECT_EQ(compare(walks({3.0}), walks({4.0})).verdict, Verdict::kBetter);
  for (const double close : {2.97, 2.7, 3.3}) {
    const auto comparison = compare(walks({close}), walks({3.0}));
    EXPECT_EQ(comparison.verdict, Verdict::kSame) << close;
    EXPECT_THAT(comparison.reasons, Contains(HasSubstr("one walk: no interval")));
  }
  // Up on one walk, down on the others: the interval straddles 0 and the rise is within the noise.
  EXPECT_EQ(compare(walks({4.6, 2.9, 2.9}), walks({3.8, 3.0, 3.0})).verdict, Verdict::kSame);
}

TEST(MapComparison, LostFloorsLostAnswersAndDishonestCirclesAreWorse) {
  EXPECT_THAT(compare(walks({3.0, 3.0}, 0.97), walks({3.0, 3.0})).reasons, Contains(HasSubstr("floor is right in 97.0 instead of 100.0 %")));
  EXPECT_THAT(compare(walks({3.0, 3.0}, 1.0, 0.80), walks({3.0, 3.0})).reasons, Contains(HasSubstr("holds 80.0 instead of 95.0 %")));
  EXPECT_EQ(compare(walks({3.0, 3.0}, 1.0, 0.92), walks({3.0, 3.0}, 1.0, 0.99)).verdict, Verdict::kSame) << "92 % is honest enough";
  auto silent = walks({3.0, 3.0});
  silent[0].instants = 60;
  EXPECT_THAT(compare(silent, walks({3.0, 3.0})).reasons, Contains(HasSubstr("80.0 instead of 100.0 % of the questions")));
}

TEST(MapComparison, WithoutACommonWalkNothingIsKnown) {
  EXPECT_EQ(compare({}, {}).verdict, Verdict::kUnknown);
  auto other = walks({3.0});
  other[0].walk_id = 9;
  EXPECT_EQ(compare(other, walks({3.0})).verdict, Verdict::kUnknown);
  auto mute = walks({3.0});
  mute[0].instants = 0;
  EXPECT_EQ(compare(mute, walks({3.0})).verdict, Verdict::kWorse);
  EXPECT_EQ(compare(walks({3.0}), mute).verdict, Verdict::kBetter);
}

TEST(PooledQuality, QuantilesOfWalksTogetherAreThoseOfTheirInstants) {
  auto two = walks({2.0, 6.0});
  two[1].instants = two[1].asked = 300;  // three quarters of the instants err by 6 m
  const PooledQuality pooled = pool(two);
  EXPECT_EQ(pooled.instants, 400u);
  EXPECT_NEAR(pooled.mean_m, 5.0, 1e-9);
  ASSERT_EQ(pooled.error_quantiles_m.size(), 101u);
  EXPECT_EQ(pooled.error_quantiles_m[20], 2.0f);
  EXPECT_EQ(pooled.error_quantiles_m[30], 6.0f);
  EXPECT_EQ(pooled.median_m, 6.0);
}

}  // namespace
}  // namespace wayfuse
