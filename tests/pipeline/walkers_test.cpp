#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "server/pipeline/walker_cloud.hpp"
#include "tests/pipeline/beacon.hpp"
#include "tests/pipeline/block.hpp"

// What walkers do: each of their rules in a world where nothing else is at work.

namespace wayfuse {
namespace {

constexpr FloorOrdinal kGround{0};
constexpr WalkerSettings kTrusting{.heading_sigma_rad = 0.0, .heading_walk_rad_rts = 0.0, .stride_sigma = 0.0, .stray_strides = 0.0};

double mean(std::span<const float> values) {
  double sum = 0.0;
  for (const float each : values) sum += static_cast<double>(each);
  return sum / static_cast<double>(values.size());
}

// Walkers who trust the phone, and points with a sigma: the textbook's filter, an axis at a time.
TEST(Walkers, AreTheKalmanFilterWhereAllIsLinearAndGaussian) {
  WalkerSettings settings = kTrusting;
  settings.particles = 40'000;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Random random(seed), noise(seed + 100);
    WalkerCloud cloud(settings);
    cloud.start_about({3.0, -2.0}, 4.0, {}, random);
    std::array<double, 2> expected = {3.0, -2.0}, truth = {1.0, 0.5};
    double variance_m2 = 16.0;
    for (int k = 0; k < 12; ++k) {
      const std::array<double, 2> walked = {1.5, k % 2 ? -1.0 : 0.6};
      const double blur_m = 0.9, sigma_m = k % 3 == 0 ? 2.0 : 5.0;
      cloud.walk(walked[0], walked[1], blur_m, 0.0, random);
      std::array<double, 2> seen;
      for (int axis = 0; axis < 2; ++axis) {
        truth[axis] += walked[axis] + blur_m * noise.normal();
        seen[axis] = truth[axis] + sigma_m * noise.normal();
      }
      cloud.weigh({seen[0], seen[1]}, sigma_m);
      cloud.settle(random);
      variance_m2 += blur_m * blur_m;
      const double gain = variance_m2 / (variance_m2 + sigma_m * sigma_m);
      for (int axis = 0; axis < 2; ++axis) expected[axis] += walked[axis] + gain * (seen[axis] - expected[axis] - walked[axis]);
      variance_m2 *= 1.0 - gain;
      const WalkerCloud::Spread spread = cloud.spread();
      // Resampled over and over: some times the 1 cm that 40,000 draws of 2 m are off by.
      EXPECT_NEAR(spread.mean.x_m, expected[0], 0.06) << "seed " << seed << ", step " << k;
      EXPECT_NEAR(spread.mean.y_m, expected[1], 0.06) << "seed " << seed << ", step " << k;
      EXPECT_NEAR(spread.covariance.xx_m2, variance_m2, 0.05 * variance_m2) << "seed " << seed << ", step " << k;
      EXPECT_NEAR(spread.covariance.yy_m2, variance_m2, 0.05 * variance_m2) << "seed " << seed << ", step " << k;
      EXPECT_NEAR(spread.covariance.xy_m2, 0.0, 0.05 * variance_m2) << "seed " << seed << ", step " << k;
    }
  }
}

// A scan of a while ago says where they were then: it fits, and moves nobody, whichever way they are turned.
TEST(Walkers, AreWeighedWhereTheyWereWhenTheScanWasHeard) {
  for (const double turned_rad : {0.0, std::numbers::pi / 2, -2.0}) {
    Random random(3);
    WalkerCloud cloud(kTrusting);
    cloud.start_about({20.0, 10.0}, 3.0, {turned_rad, false}, random);
    const BuildingPoint before = cloud.spread().mean;
    const BuildingPoint carried{6.0, -8.0};  // by the phone; they went turned against it
    const double dx_m = std::cos(turned_rad) * carried.x_m - std::sin(turned_rad) * carried.y_m;
    const double dy_m = std::sin(turned_rad) * carried.x_m + std::cos(turned_rad) * carried.y_m;
    const Beacon then({before.x_m - dx_m, before.y_m - dy_m});
    cloud.weigh(then, kGround, carried, 0.0);
    cloud.settle(random);
    EXPECT_LT(distance_m(cloud.spread().mean, before), 0.4) << turned_rad;
  }
}

// Whoever begins from a scan of a while ago has walked on since.
TEST(Walkers, BegunFromAnOldScanHaveWalkedOn) {
  Random random(4);
  WalkerCloud cloud(kTrusting);
  Beacon then({20.0, 10.0});
  cloud.start_from(then, kGround, {6.0, -8.0}, {std::numbers::pi / 2, false}, random);
  EXPECT_LT(distance_m(cloud.spread().mean, {28.0, 16.0}), 0.4);
}

// A scan heard 30 m off is a million times likelier on the near rim of a cloud than in its middle; yet it may be a wrong one.
TEST(Walkers, AScanFromElsewhereDoesNotTearTheCloudApart) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    WalkerCloud cloud({});
    cloud.start_about({0.0, 0.0}, 3.0, {}, random);
    const WalkerCloud::Spread before = cloud.spread();
    cloud.weigh(Beacon({30.0, 0.0}), kGround, {}, 0.0);
    cloud.settle(random);
    const WalkerCloud::Spread after = cloud.spread();
    EXPECT_LT(distance_m(after.mean, before.mean), 2.0) << "seed " << seed;
    EXPECT_GT(after.covariance.yy_m2, 0.7 * before.covariance.yy_m2) << "seed " << seed;
  }
}

// Half of what a scan by the wall draws is beyond it.
TEST(Walkers, BeginOnTheInnerSideOfWalls) {
  Floor hall;
  hall.outline = {{{{0, 0}, {40, 0}, {40, 20}, {0, 20}}}};
  const WalkableArea walls(std::array{hall}, {});
  const auto beyond = [&](const WalkerCloud& cloud) {
    double weight = 0.0;
    for (std::size_t i = 0; i < cloud.particles().size(); ++i) {
      const float x_m = cloud.particles().x_m()[i], y_m = cloud.particles().y_m()[i];
      if (!walls.plan(kGround)->open(x_m, y_m)) weight += std::exp(static_cast<double>(cloud.particles().log_weight()[i]));
    }
    return weight;
  };
  Beacon by_the_wall({20.0, -1.5});
  Random random(6);
  WalkerCloud fresh({});
  fresh.enter(walls.plan(kGround));
  fresh.start_from(by_the_wall, kGround, {}, {}, random);
  EXPECT_LT(beyond(fresh), 0.01);
  WalkerCloud renewed({});
  renewed.enter(walls.plan(kGround));
  renewed.start_about({20.0, 12.0}, 1.0, {}, random);
  renewed.renew(0.3, by_the_wall, kGround, {}, {}, random);
  renewed.settle(random);
  EXPECT_LT(beyond(renewed), 0.01);
}

// A fresh crowd: most strides within 6 % of the phone's, some far from it.
TEST(Walkers, HaveStridesOfTheirOwn) {
  WalkerCloud cloud({.particles = 20'000});
  Random random(5);
  cloud.start_about({}, 3.0, {}, random);
  const auto strides = cloud.particles().stride_scale().first(cloud.particles().size());
  const auto share_beyond = [&](double off) {
    const auto beyond = [off](float each) { return std::abs(static_cast<double>(each) - 1.0) > off; };
    return static_cast<double>(std::ranges::count_if(strides, beyond)) / static_cast<double>(strides.size());
  };
  EXPECT_NEAR(mean(strides), 1.0, 0.01);
  EXPECT_NEAR(share_beyond(0.06), 0.85 * 0.317 + 0.15 * 0.810, 0.02);  // normal, sigma 0.06 and 0.25
  EXPECT_NEAR(share_beyond(0.25), 0.15 * 0.317, 0.01);
}

/// A straight walk of a phone that counts every metre as `counted` of one, its compass turning away by `drift_radps`, scans within
/// 3 m every 2 s; then 16 s without any. How far off it is by then, seeds on average.
double error_after_silence_m(const WalkerSettings& settings, double counted, double drift_radps) {
  double sum_m = 0.0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    WalkerCloud cloud(settings);
    Random random(seed), noise(seed + 100);
    cloud.start_about({}, 3.0, {}, random);
    double walked_m = 0.0;
    for (double t = 0.5; t <= 106.0; t += 0.5) {
      walked_m += 0.7;
      const double blur_m = 0.35 * std::sqrt(0.7 * counted);
      cloud.walk(0.7 * counted * std::cos(drift_radps * t), 0.7 * counted * std::sin(drift_radps * t), blur_m, 0.5, random);
      if (std::fmod(t, 2.0) != 0.0 || t > 90.0) continue;
      const double x_m = walked_m + 3.0 * noise.normal(), y_m = 3.0 * noise.normal();
      cloud.weigh(Beacon({x_m, y_m}), kGround, {}, 0.0);
      cloud.settle(random);
    }
    sum_m += distance_m(cloud.spread().mean, {walked_m, 0.0}) / 12.0;
  }
  return sum_m;
}

TEST(Walkers, LearnTheStrideOfAPhoneThatCountsShort) {
  WalkerSettings alike;
  alike.stride_sigma = alike.stray_strides = 0.0;
  for (const double counted : {0.8, 1.25}) {
    const double learnt_m = error_after_silence_m({}, counted, 0.0), not_learnt_m = error_after_silence_m(alike, counted, 0.0);
    EXPECT_LT(learnt_m, 0.5 * not_learnt_m) << "a metre counted as " << counted;
    EXPECT_LT(learnt_m, 4.0) << "a metre counted as " << counted;
  }
}

TEST(Walkers, FollowACompassThatDrifts) {
  WalkerSettings steady;
  steady.heading_walk_rad_rts = 0.0;
  for (const double drift_radps : {-0.008, 0.008}) {
    const double followed_m = error_after_silence_m({}, 1.0, drift_radps), not_followed_m = error_after_silence_m(steady, 1.0, drift_radps);
    EXPECT_LT(followed_m, 0.65 * not_followed_m) << drift_radps;
    EXPECT_LT(followed_m, 11.0) << drift_radps;
  }
}

// Walls of a corridor 3 m wide, and 1.5 m either side that plans may be off by:
//
//   +-----------+
//   | +-------+ |     scans on the first side only, then once around;
//   | |       | |     the compass 0.25 rad off
//   | +-------+ |
//   +-----------+
std::shared_ptr<const TrackerFactory> corridor(bool walkable) {
  const auto square = [](double margin_m) {
    const double low_m = -margin_m, high_m = block::kSide_m + margin_m;
    return Ring{{low_m, low_m}, {high_m, low_m}, {high_m, high_m}, {low_m, high_m}};
  };
  auto site = std::make_shared<Site>(*block::block_site());
  for (Floor& floor : site->floors) floor.walkable = {{{square(1.5), square(-1.5)}}};
  PipelineSpec spec = *preset("default");
  spec.parts["filter"].settings["walkable"] = walkable ? 1.0 : 0.0;
  return *assemble(spec, site);
}

struct Blind {
  double in_ring = 0.0;            ///< share of the positions since the last scan
  double error_m = 0.0;            ///< on average
};
Blind blind(const TrackerFactory& factory, double compass_error_rad) {
  Blind blind;
  int asked = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto tracker = factory.make_tracker(Random(seed));
    for (double t = 0.5; t <= 88.0; t += 0.5) {
      const BuildingPoint a = block::around(block::kSpeedMps * (t - 0.5)), b = block::around(block::kSpeedMps * t);
      tracker->feed(block::step(t, std::atan2(b.y_m - a.y_m, b.x_m - a.x_m) + compass_error_rad));
      if (std::fmod(t, 2.0) == 0.0 && t <= 20.0) tracker->feed(block::scan_at(b, 1, t));
      if (t <= 20.0) continue;
      const BuildingPoint now = tracker->position(PhoneTime(from_seconds(t)))->place.point;
      const double off_m = std::max(std::abs(now.x_m - block::kSide_m / 2), std::abs(now.y_m - block::kSide_m / 2)) - block::kSide_m / 2;
      blind.in_ring += std::abs(off_m) < 3.5;
      blind.error_m += distance_m(now, b);
      ++asked;
    }
  }
  return {blind.in_ring / asked, blind.error_m / asked};
}

TEST(Walkers, AreLedByWallsWhereTheCompassIsOffAndNothingIsHeard) {
  const auto with = corridor(true), without = corridor(false);
  for (const double compass_error_rad : {-0.25, 0.25}) {
    const Blind led = blind(*with, compass_error_rad), astray = blind(*without, compass_error_rad);
    EXPECT_GT(led.in_ring, 0.99) << "compass off by " << compass_error_rad;
    EXPECT_LT(led.error_m, 1.5) << "compass off by " << compass_error_rad;
    EXPECT_LT(led.error_m, 0.5 * astray.error_m) << "compass off by " << compass_error_rad;
  }
}

}  // namespace
}  // namespace wayfuse
