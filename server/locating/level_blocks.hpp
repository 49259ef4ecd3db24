#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// What is heard where, and how loudly: a sparse matrix, fingerprints x transmitters, laid out to ask one scan against every
/// fingerprint.
///
/// Fingerprints stand in blocks of kBlock; a transmitter holds the blocks that hear it, each with kBlock levels, 0 where it is
/// not heard. Fingerprints near one another hear the same transmitters: given in space_filling_order() they make full blocks.
/// A sum over a scan then costs one pass over whole vectors instead of a scattered addition a level. Every sum has its own
/// lane and its own order of additions, nothing is fused: the same bits on every vector width (Highway, dispatched at run
/// time). Immutable.
class LevelBlocks {
 public:
  static constexpr std::size_t kBlock = 32;
  struct Level {
    std::uint32_t fingerprint = 0;
    std::uint32_t transmitter = 0;
    float value = 0.0f;
  };

  LevelBlocks() = default;
  LevelBlocks(std::size_t fingerprints, std::size_t transmitters, std::span<const Level> levels);

  /// Number of fingerprints, rounded up to whole blocks: the length of every column of sums.
  std::size_t padded() const { return padded_; }
  /// Sums of the blocks that hear the transmitter become 0 where `touched`, a flag a block, does not say that they are sums already.
  void touch(std::uint32_t transmitter, std::span<std::uint8_t> touched, std::span<float> sums) const;
  /// products += value * level for every fingerprint that hears the transmitter.
  void add_products(std::uint32_t transmitter, float value, std::span<float> products) const;
  /// The same, and overlaps += the smaller of |value| and |level| where both have one sign.
  void add_overlaps_and_products(std::uint32_t transmitter, float value, std::span<float> overlaps, std::span<float> products) const;
  /// Calls each(fingerprint, level) for every level of the transmitter that is not 0, ascending.
  void for_each_level(std::uint32_t transmitter, const auto& each) const {
    for (std::uint32_t b = first_[transmitter]; b < first_[transmitter + 1]; ++b) {
      for (std::uint32_t lane = 0; lane < kBlock; ++lane) {
        const float value = values_[b * kBlock + lane];
        if (value != 0.0f) each(start_[b] + lane, value);
      }
    }
  }

 private:
  std::size_t padded_ = 0;
  std::vector<std::uint32_t> first_;   // a transmitter, and one past the end: its blocks
  std::vector<std::uint32_t> start_;   // a block: its first fingerprint
  std::vector<float> values_;          // a block: kBlock levels
};

/// The least of own[i] + all - 2 shared[i] in each block of LevelBlocks::kBlock that was touched. Lengths are whole blocks.
void least_from_shared(std::span<const float> own, float all, std::span<const float> shared, std::span<const std::uint8_t> touched,
                       std::span<float> least_of_block);

/// A mixture of Sorensen's distance and the cosine's, from sums over what both sides heard; lengths are whole blocks.
///
/// sorensen[i] = 1 - 2 overlaps[i] / (total + totals[i]); cosine[i] = 1 - products[i] / (norm norms[i]).
void similarity_distances(float total, std::span<const float> totals, std::span<const float> overlaps, std::span<float> sorensen,
                          float norm, std::span<const float> norms, std::span<const float> products, std::span<float> cosine);

/// The order along Morton's curve, floor by floor: neighbours in the plane are neighbours in the order. Ties keep their order.
std::vector<std::uint32_t> space_filling_order(std::span<const Place> places);

}  // namespace wayfuse
