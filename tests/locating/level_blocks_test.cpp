#include "server/locating/level_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/tracking/particle_kernels.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

struct Sums {
  std::vector<float> overlaps, products;
  bool operator==(const Sums&) const = default;
};

TEST(LevelBlocks, SumsEqualTheScalarOnesToTheBitOnEveryVectorWidth) {
  constexpr std::size_t kFingerprints = 77, kTransmitters = 12;
  Random random(3);
  std::vector<LevelBlocks::Level> levels;
  for (std::uint32_t i = 0; i < kFingerprints; ++i) {
    for (std::uint32_t t = 0; t < kTransmitters; ++t) {
      if (random.uniform() < 0.3) levels.push_back({i, t, static_cast<float>(3.0 * random.normal())});
    }
  }
  const LevelBlocks blocks(kFingerprints, kTransmitters, levels);
  ASSERT_EQ(blocks.padded(), 96u);
  std::vector<float> scan;
  for (std::size_t t = 0; t < kTransmitters; ++t) scan.push_back(static_cast<float>(3.0 * random.normal()));

  Sums expected{std::vector<float>(96), std::vector<float>(96)};
  for (std::uint32_t t = 0; t < kTransmitters; ++t) {  // in the order the blocks are asked, as rounding depends on it
    for (const LevelBlocks::Level& level : levels) {
      if (level.transmitter != t) continue;
      expected.products[level.fingerprint] += scan[t] * level.value;
      if (scan[t] * level.value > 0.0f) expected.overlaps[level.fingerprint] += std::min(std::abs(scan[t]), std::abs(level.value));
    }
  }
  const std::size_t widths = kernels::use_only_target_for_test(0);
  for (std::size_t n = 1; n <= widths; ++n) {
    kernels::use_only_target_for_test(n);
    Sums both{std::vector<float>(96), std::vector<float>(96)};
    std::vector<float> products(96);
    for (std::uint32_t t = 0; t < kTransmitters; ++t) {
      blocks.add_overlaps_and_products(t, scan[t], both.overlaps, both.products);
      blocks.add_products(t, scan[t], products);
    }
    EXPECT_EQ(both, expected) << "vector unit " << n;
    EXPECT_EQ(products, expected.products) << "vector unit " << n;
  }
  kernels::use_only_target_for_test(0);
}

TEST(LevelBlocks, TellWhatTheyWereGiven) {
  const std::vector<LevelBlocks::Level> levels = {{40, 2, 5.0f}, {0, 2, 1.0f}, {31, 2, 2.0f}, {32, 0, 4.0f}};
  const LevelBlocks blocks(41, 4, levels);
  std::vector<std::pair<std::uint32_t, float>> told;
  blocks.for_each_level(2, [&](std::uint32_t fingerprint, float value) { told.emplace_back(fingerprint, value); });
  EXPECT_EQ(told, (std::vector<std::pair<std::uint32_t, float>>{{0, 1.0f}, {31, 2.0f}, {40, 5.0f}}));
  told.clear();
  for (const std::uint32_t silent : {1u, 3u}) blocks.for_each_level(silent, [&](std::uint32_t f, float v) { told.emplace_back(f, v); });
  EXPECT_TRUE(told.empty());
}

TEST(SpaceFillingOrder, KeepsFloorsApartAndNeighboursTogether) {
  std::vector<Place> places;
  for (int i = 0; i < 256; ++i) places.push_back({{static_cast<double>(i % 16), static_cast<double>(i / 16)}, FloorOrdinal{i % 2}});
  const auto order = space_filling_order(places);
  std::vector<std::uint32_t> sorted(order);
  std::ranges::sort(sorted);
  for (std::uint32_t i = 0; i < 256; ++i) ASSERT_EQ(sorted[i], i) << "a permutation";
  // The 32 of a block span a quarter of the square: 8 x 4 m of every second column.
  for (std::size_t block = 0; block < 256; block += 32) {
    double low = 1e9, high = -1e9;
    for (std::size_t k = block; k < block + 32; ++k) {
      EXPECT_EQ(places[order[k]].floor, FloorOrdinal{block < 128 ? 0 : 1});
      low = std::min(low, places[order[k]].point.y_m), high = std::max(high, places[order[k]].point.y_m);
    }
    EXPECT_LE(high - low, 8.0);
  }
}

}  // namespace
}  // namespace wayfuse
