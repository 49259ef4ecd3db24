#include "server/quality/metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wayfuse {
namespace {

TEST(Metrics, SummaryOfFiveErrors) {
  // Sorted 1 2 3 4 10: mean 20/5, squares 1+4+9+16+100 = 130, p90 lies 0.6 of the way from 4 to 10.
  const ErrorSummary summary = summarise({3, 1, 10, 2, 4});
  EXPECT_EQ(summary.n, 5u);
  EXPECT_DOUBLE_EQ(summary.mean, 4.0);
  EXPECT_DOUBLE_EQ(summary.rmse, std::sqrt(26.0));
  EXPECT_DOUBLE_EQ(summary.median, 3.0);
  EXPECT_DOUBLE_EQ(summary.p75, 4.0);
  EXPECT_DOUBLE_EQ(summary.p90, 4.0 + 0.6 * 6.0);
}

TEST(Metrics, NothingHasNoMean) {
  EXPECT_TRUE(std::isnan(summarise({}).mean));
  EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
}

TEST(Metrics, RankCorrelationSeesOrderNotSize) {
  const double a[] = {1, 2, 3, 4};
  const double rising[] = {1, 10, 100, 1000};
  const double falling[] = {5, 4, 3, -900};
  const double flat[] = {2, 2, 2, 2};
  EXPECT_DOUBLE_EQ(rank_correlation(a, rising).value(), 1.0);
  EXPECT_DOUBLE_EQ(rank_correlation(a, falling).value(), -1.0);
  EXPECT_FALSE(rank_correlation(a, flat));
}

TEST(Metrics, TiesShareTheMeanRank) {
  // Ranks 0 1.5 1.5 3 against 0 1 2 3: covariance 4.5, variances 4.5 and 5.
  const double a[] = {1, 2, 2, 3};
  const double b[] = {1, 2, 3, 4};
  EXPECT_DOUBLE_EQ(rank_correlation(a, b).value(), 4.5 / std::sqrt(4.5 * 5.0));
}

TEST(Metrics, BootstrapIntervalHoldsTheMeanAndIsReproducible) {
  std::vector<GroupSum> walks;
  Random random(7);
  for (int i = 0; i < 100; ++i) walks.push_back({5.0 + random.normal(), 1});
  const Interval interval = bootstrap_mean(walks, Random(1));
  // The standard error of the mean of 100 unit normals is 0.1: 1.96 of them each side, give or take the draw.
  EXPECT_NEAR(interval.high - interval.low, 0.39, 0.08);
  const Interval again = bootstrap_mean(walks, Random(1));
  EXPECT_EQ(interval.low, again.low);
  EXPECT_EQ(interval.high, again.high);
}

TEST(Metrics, PairedDifferenceIsSharperThanTwoIntervals) {
  std::vector<GroupSum> a;
  std::vector<GroupSum> b;
  Random random(3);
  for (int i = 0; i < 60; ++i) {
    const double hardness = 4.0 * random.uniform();  // a walk is hard for both
    a.push_back({10.0 * (4.0 + hardness), 10});
    b.push_back({10.0 * (3.8 + hardness), 10});
  }
  const PairedDifference difference = paired_difference(a, b, Random(1));
  EXPECT_NEAR(difference.difference, -0.2, 1e-9);
  EXPECT_LT(difference.interval.high, -0.19);
  EXPECT_DOUBLE_EQ(difference.share_better, 1.0);
}

}  // namespace
}  // namespace wayfuse
