#include "server/tracking/particle_kernels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "server/tracking/noise.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kSize = 208;  // a multiple of 16, not of 64

// Calls `check` once on every vector unit of this machine.
void on_every_unit(const auto& check) {
  const std::size_t units = kernels::use_only_target_for_test(0);
  ASSERT_GT(units, 0u);
  for (std::size_t unit = 1; unit <= units; ++unit) {
    kernels::use_only_target_for_test(unit);
    SCOPED_TRACE(unit);
    check();
  }
  kernels::use_only_target_for_test(0);
}

TEST(ParticleKernels, WalkEqualsTheScalarReferenceBitByBitOnEveryUnit) {
  on_every_unit([] {
    std::vector<float> x(kSize, 3.0f), y(kSize, -7.0f);
    kernels::walk(x.data(), y.data(), kSize, 0.7f, -0.2f, 0.3f, 0x123456789abcdefu);
    const Noise noise(0x123456789abcdefu);
    for (std::uint32_t i = 0; i < kSize; ++i) {
      const Noise::Pair n = noise.normal(i);
      EXPECT_EQ(x[i], 3.0f + (0.7f + 0.3f * n.first));
      EXPECT_EQ(y[i], -7.0f + (-0.2f + 0.3f * n.second));
    }
  });
}

TEST(ParticleKernels, WalkTurnedEqualsTheScalarReferenceBitByBitOnEveryUnit) {
  on_every_unit([] {
    std::vector<float> x(kSize, 3.0f), y(kSize, -7.0f), bias(kSize), scale(kSize);
    for (std::size_t i = 0; i < kSize; ++i) bias[i] = 0.07f * (static_cast<float>(i) - 100.0f), scale[i] = 0.8f + 0.002f * static_cast<float>(i);
    kernels::walk_turned(x.data(), y.data(), bias.data(), scale.data(), kSize, 0.7f, -0.2f, 0.3f, 0x123456789abcdefu);
    const Noise noise(0x123456789abcdefu);
    for (std::uint32_t i = 0; i < kSize; ++i) {
      const Noise::Pair n = noise.normal(i);
      const CosineAndSine way = cosine_and_sine(bias[i]);
      const float c = scale[i] * way.cosine, s = scale[i] * way.sine;
      EXPECT_EQ(x[i], 3.0f + ((c * 0.7f - s * -0.2f) + 0.3f * n.first));
      EXPECT_EQ(y[i], -7.0f + ((s * 0.7f + c * -0.2f) + 0.3f * n.second));
    }
  });
}

TEST(ParticleKernels, SquaredDistanceEqualsTheScalarReferenceForAnyLength) {
  on_every_unit([] {
    for (const std::size_t size : {std::size_t{1}, std::size_t{15}, std::size_t{77}}) {
      std::vector<float> x(size), y(size), gained(size, 1.0f);
      for (std::size_t i = 0; i < size; ++i) x[i] = 0.37f * static_cast<float>(i), y[i] = -0.11f * static_cast<float>(i);
      kernels::add_squared_distance(x, y, 2.0f, 1.0f, -0.3f, gained);
      for (std::size_t i = 0; i < size; ++i) {
        const float dx = x[i] - 2.0f, dy = y[i] - 1.0f;
        EXPECT_EQ(gained[i], 1.0f + -0.3f * (dx * dx + dy * dy));
      }
    }
  });
}

TEST(ParticleKernels, ExponentialsAreRightToSevenDigitsAndTheSameOnEveryUnit) {
  std::vector<float> logs(kSize);
  for (std::size_t i = 0; i < kSize; ++i) logs[i] = -0.45f * static_cast<float>(i);  // down to -93
  logs[5] = -std::numeric_limits<float>::infinity();
  std::vector<float> reference;
  on_every_unit([&] {
    std::vector<float> out(kSize);
    kernels::exponentials(logs.data(), kSize, 0.0f, out.data());
    for (std::size_t i = 0; i < kSize; ++i) {
      const double expected = logs[i] < -87.0f ? 0.0 : std::exp(static_cast<double>(logs[i]));
      EXPECT_NEAR(static_cast<double>(out[i]), expected, 3e-7 * expected) << logs[i];
    }
    if (reference.empty()) reference = out;
    EXPECT_EQ(out, reference);
  });
}

TEST(ParticleKernels, GatheringAndSummingEqualTheScalarReferenceBitByBitOnEveryUnit) {
  std::vector<float> values(kSize);
  std::vector<std::uint32_t> from(kSize);
  std::array<float, 16> expected_sums{}, expected_squares{};
  for (std::uint32_t i = 0; i < kSize; ++i) {
    values[i] = 1.0f / static_cast<float>(i + 3);
    from[i] = 131u * i % kSize;
    expected_sums[i % 16] += values[i];
    expected_squares[i % 16] += values[i] * values[i];
  }
  on_every_unit([&] {
    std::vector<float> gathered(kSize), shifted = values, scaled = values;
    kernels::gather(values.data(), from.data(), kSize, gathered.data());
    std::array<float, 16> sums, squares;
    kernels::sums_of_sixteen(values.data(), kSize, sums, squares);
    EXPECT_EQ(sums, expected_sums);
    EXPECT_EQ(squares, expected_squares);
    kernels::shift_and_scale(shifted.data(), 0.3f, scaled.data(), 1.7f, kSize);
    for (std::size_t i = 0; i < kSize; ++i) {
      EXPECT_EQ(gathered[i], values[from[i]]);
      EXPECT_EQ(shifted[i], values[i] - 0.3f);
      EXPECT_EQ(scaled[i], values[i] * 1.7f);
    }
  });
}

TEST(ParticleKernels, MaximumTurnsNaNIntoNothing) {
  on_every_unit([] {
    std::vector<float> logs(32, -5.0f);
    logs[3] = std::numeric_limits<float>::quiet_NaN();
    logs[30] = -1.0f;
    EXPECT_EQ(kernels::clean_and_max(logs.data(), 32), -1.0f);
    EXPECT_EQ(logs[3], -std::numeric_limits<float>::infinity());
  });
}

TEST(Noise, LogarithmAndCircleAreWithinTheirStatedErrors) {
  for (int i = 1; i <= 100000; ++i) {
    const auto u = static_cast<float>(i) / 100000.0f;
    EXPECT_NEAR(static_cast<double>(log_of_unit(u)), std::log(static_cast<double>(u)), 2e-6);
    const auto turn = static_cast<float>(i - 1) / 100000.0f;
    const CosineAndSine way = cosine_and_sine_of_turn(turn);
    EXPECT_NEAR(static_cast<double>(way.cosine), std::cos(2 * std::numbers::pi * static_cast<double>(turn)), 6e-7);
    EXPECT_NEAR(static_cast<double>(way.sine), std::sin(2 * std::numbers::pi * static_cast<double>(turn)), 6e-7);
  }
}

TEST(Noise, CircleTakesAnyAngle) {
  for (float angle = -10.0f; angle <= 10.0f; angle += 0.001f) {
    const CosineAndSine way = cosine_and_sine(angle);
    EXPECT_NEAR(static_cast<double>(way.cosine), std::cos(static_cast<double>(angle)), 2e-6);
    EXPECT_NEAR(static_cast<double>(way.sine), std::sin(static_cast<double>(angle)), 2e-6);
  }
}

TEST(Noise, HasTheMomentsOfANormalDistribution) {
  constexpr std::uint32_t kMany = 1000000;
  const Noise noise(99);
  double mean = 0, square = 0, fourth = 0, cross = 0;
  for (std::uint32_t i = 0; i < kMany; ++i) {
    const Noise::Pair n = noise.normal(i);
    const double a = static_cast<double>(n.first), b = static_cast<double>(n.second);
    mean += a, square += a * a, fourth += a * a * a * a, cross += a * b;
  }
  EXPECT_NEAR(mean / kMany, 0.0, 0.005);      // five sigmas of a mean of a million
  EXPECT_NEAR(square / kMany, 1.0, 0.007);
  EXPECT_NEAR(fourth / kMany, 3.0, 0.05);
  EXPECT_NEAR(cross / kMany, 0.0, 0.005);
}

}  // namespace
}  // namespace wayfuse
