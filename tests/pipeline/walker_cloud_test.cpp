#include "server/pipeline/walker_cloud.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/pipeline/beacon.hpp"

namespace wayfuse {
namespace {

constexpr FloorOrdinal kGround{0};

// The textbook's two passes, in double precision.
WalkerCloud::Spread reference(const ParticleCloud& cloud) {
  WalkerCloud::Spread spread{};
  double sum = 0.0;
  const auto weight = [&](std::size_t i) { return std::exp(static_cast<double>(cloud.log_weight()[i])); };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    sum += weight(i);
    spread.mean.x_m += weight(i) * static_cast<double>(cloud.x_m()[i]);
    spread.mean.y_m += weight(i) * static_cast<double>(cloud.y_m()[i]);
  }
  spread.mean = {spread.mean.x_m / sum, spread.mean.y_m / sum};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double dx_m = static_cast<double>(cloud.x_m()[i]) - spread.mean.x_m, dy_m = static_cast<double>(cloud.y_m()[i]) - spread.mean.y_m;
    spread.covariance.xx_m2 += weight(i) / sum * dx_m * dx_m;
    spread.covariance.xy_m2 += weight(i) / sum * dx_m * dy_m;
    spread.covariance.yy_m2 += weight(i) / sum * dy_m * dy_m;
  }
  return spread;
}

// Sizes that fill no whole block, and a place far from the frame's origin.
TEST(WalkerCloud, SpreadIsTheWeightedMeanAndCovariance) {
  for (const int particles : {10, 16, 255, 256, 1000}) {
    for (const double far_m : {0.0, 3900.0}) {
      WalkerCloud cloud({.particles = particles});
      Random random(5);
      cloud.start_about({far_m, -far_m}, 12.0, {}, random);
      cloud.weigh({far_m + 5.0, -far_m}, 6.0);
      cloud.settle(random);
      const WalkerCloud::Spread spread = cloud.spread(), expected = reference(cloud.particles());
      EXPECT_NEAR(spread.mean.x_m, expected.mean.x_m, 1e-4);
      EXPECT_NEAR(spread.mean.y_m, expected.mean.y_m, 1e-4);
      EXPECT_NEAR(spread.covariance.xx_m2, expected.covariance.xx_m2, 1e-3);
      EXPECT_NEAR(spread.covariance.xy_m2, expected.covariance.xy_m2, 1e-3);
      EXPECT_NEAR(spread.covariance.yy_m2, expected.covariance.yy_m2, 1e-3);
    }
  }
}

TEST(WalkerCloud, WalkersOnOnePointHaveNoSpread) {
  WalkerCloud cloud({});
  Random random(5);
  cloud.start_about({3900.0, 3900.0}, 0.0, {}, random);
  const WalkerCloud::Spread spread = cloud.spread();
  EXPECT_EQ(spread.mean, (BuildingPoint{3900.0, 3900.0}));
  EXPECT_EQ(spread.covariance, Covariance{});
}

// Of a resampled cloud walkers in a row are one ancestor's: a row of them renewed would be a place forgotten.
TEST(WalkerCloud, RenewsOneWalkerOfEachRowAndNoOther) {
  WalkerCloud cloud({});
  Beacon beacon({500.0, 0.0});
  Random random(7);
  cloud.start_about({0.0, 0.0}, 3.0, {}, random);
  cloud.renew(0.05, beacon, kGround, {}, {}, random);
  for (std::size_t row = 0; row < 50; ++row) {
    int renewed = 0;
    for (std::size_t i = 20 * row; i < 20 * (row + 1); ++i) renewed += cloud.particles().x_m()[i] > 400.0f;
    EXPECT_EQ(renewed, 1) << row;
  }
}

}  // namespace
}  // namespace wayfuse
