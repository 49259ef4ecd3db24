#include "server/tracking/resamplers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace wayfuse {
namespace {

// Particle i stands at x = i with weight ~ i + 1.
ParticleCloud wedge(std::size_t size) {
  ParticleCloud cloud(size, 0);
  for (std::size_t i = 0; i < size; ++i) {
    cloud.x_m()[i] = static_cast<float>(i);
    cloud.log_weight()[i] = std::log(static_cast<float>(i + 1));
  }
  cloud.normalise();
  return cloud;
}

double count_of(const ParticleCloud& cloud, float x) {
  double count = 0;
  for (const float each : cloud.x_m()) count += each == x;
  return count;
}

class UnbiasedResampler : public testing::TestWithParam<std::shared_ptr<const Resampler>> {};

TEST_P(UnbiasedResampler, TakesEachParticleInProportionToItsWeight) {
  constexpr int kRuns = 4000;
  constexpr std::size_t kSize = 10;
  Random random(11);
  std::vector<double> taken(kSize);
  for (int run = 0; run < kRuns; ++run) {
    ParticleCloud cloud = wedge(kSize);
    GetParam()->resample(cloud, random);
    for (std::size_t i = 0; i < kSize; ++i) taken[i] += count_of(cloud, static_cast<float>(i));
  }
  for (std::size_t i = 0; i < kSize; ++i) {
    const double expected = kSize * static_cast<double>(i + 1) / 55.0;  // of one run; 1 + ... + 10 = 55
    // Multinomial sampling has the largest variance, N w (1 - w) a run: five of its sigmas.
    EXPECT_NEAR(taken[i] / kRuns, expected, 5.0 * std::sqrt(expected / kRuns)) << i;
  }
}

TEST_P(UnbiasedResampler, LeavesEqualWeights) {
  Random random(3);
  ParticleCloud cloud = wedge(100);
  GetParam()->resample(cloud, random);
  for (const float weight : cloud.log_weight()) EXPECT_FLOAT_EQ(weight, -std::log(100.0f));
}

TEST_P(UnbiasedResampler, KeepsTheOnlySurvivor) {
  Random random(3);
  ParticleCloud cloud = wedge(50);
  for (float& weight : cloud.log_weight()) weight = -INFINITY;
  cloud.log_weight()[17] = 0.0f;
  ASSERT_TRUE(cloud.normalise());
  GetParam()->resample(cloud, random);
  for (const float x : cloud.x_m()) EXPECT_EQ(x, 17.0f);
}

INSTANTIATE_TEST_SUITE_P(All, UnbiasedResampler,
                         testing::Values(std::make_shared<MultinomialResampler>(), std::make_shared<SystematicResampler>(),
                                         std::make_shared<ResidualResampler>(),
                                         std::make_shared<PerturbingResampler>(PerturbingSettings{0.0, 1.0})));

// Half of the weight on one of 100 particles: independent draws take it 50 times, give or take 5 = sqrt(N w (1 - w)).
TEST(MultinomialResampler, DrawsEachParticleIndependently) {
  constexpr int kRuns = 4000;
  Random random(5);
  double squares = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    ParticleCloud cloud(100, 0);
    for (std::size_t i = 0; i < 100; ++i) {
      cloud.x_m()[i] = static_cast<float>(i);
      cloud.log_weight()[i] = std::log(i == 40 ? 99.0f : 1.0f);
    }
    cloud.normalise();
    MultinomialResampler{}.resample(cloud, random);
    squares += std::pow(count_of(cloud, 40.0f) - 50.0, 2);
  }
  EXPECT_NEAR(squares / kRuns, 25.0, 5.0 * 25.0 * std::sqrt(2.0 / kRuns));
}

TEST(SystematicResampler, TakesFloorOrCeilingOfEachShare) {
  Random random(7);
  ParticleCloud cloud = wedge(20);
  SystematicResampler{}.resample(cloud, random);
  for (int i = 0; i < 20; ++i) {
    const double expected = 20.0 * (i + 1) / 210.0;
    EXPECT_LT(std::abs(count_of(cloud, static_cast<float>(i)) - expected), 1.0 + 1e-6) << i;
  }
}

// Pointer k belongs to the particle whose share of the running sum it lies in; nobody without weight has any, at either end.
TEST(SystematicResampler, GivesEveryPointerToTheParticleItLiesIn) {
  constexpr std::size_t kMany = 997;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    ParticleCloud cloud(kMany, 0);
    for (std::size_t i = 0; i < kMany; ++i) {
      cloud.x_m()[i] = static_cast<float>(i);
      const bool none = i < 20 || i >= kMany - 20 || random.uniform() < 0.3;
      cloud.log_weight()[i] = none ? -std::numeric_limits<float>::infinity() : static_cast<float>(8.0 * random.normal());
    }
    ASSERT_TRUE(cloud.normalise());
    const std::vector<float> weights(cloud.weights().begin(), cloud.weights().end());
    Random again = random;
    const double first = again.uniform();
    SystematicResampler{}.resample(cloud, random);
    double below = 0.0;
    std::size_t k = 0;
    for (std::size_t i = 0; i < kMany; ++i) {
      const double above = below + kMany * static_cast<double>(weights[i]);
      for (; k < kMany && cloud.x_m()[k] == static_cast<float>(i); ++k) {
        EXPECT_GT(weights[i], 0.0f) << i;
        EXPECT_GT(first + static_cast<double>(k), below - 0.02) << i;
        EXPECT_LT(first + static_cast<double>(k), above + 0.02) << i;
      }
      below = above;
    }
    EXPECT_EQ(k, kMany);
  }
}

TEST(PerturbingResampler, MovesItsShareOfTheParticles) {
  Random random(9);
  ParticleCloud cloud(10000, 0);
  cloud.normalise();
  PerturbingResampler({0.3, 2.0}).resample(cloud, random);
  double moved = 0, xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto x = static_cast<double>(cloud.x_m()[i]), y = static_cast<double>(cloud.y_m()[i]);
    EXPECT_EQ(x != 0.0, y != 0.0);
    moved += x != 0.0;
    xx += x * x, xy += x * y, yy += y * y;
  }
  EXPECT_NEAR(moved / 10000, 0.3, 0.025);        // five sigmas of a share of 0.3 among 10,000
  EXPECT_NEAR(xx / moved, 4.0, 0.6);
  EXPECT_NEAR(yy / moved, 4.0, 0.6);
  EXPECT_NEAR(xy / moved, 0.0, 0.4);
}

}  // namespace
}  // namespace wayfuse
