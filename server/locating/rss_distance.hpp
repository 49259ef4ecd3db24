#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/locating/level_blocks.hpp"
#include "server/locating/radio_map.hpp"

namespace wayfuse {

struct RssDistanceSettings {
  double exponent = 2.0;           ///< a of [P2]: 1 Manhattan, 2 Euclidean as [P1 eq. 1]
  double floor_dbm = -100.0;       ///< level assumed for a transmitter heard on one side only
};

/// Minkowski distances in signal space from one scan to every point of a map, and the nearest points.
///
/// D_j = (sum_i |rss_i - RSS_ji|^a)^(1/a) over every transmitter the map knows that is heard in the scan, at the point, or
/// both [P1 eq. 1, P2]; heard on one side only counts as `floor_dbm` on the other. Transmitters the map does not know
/// count nowhere: they add the same to every D_j^a.
///
/// With levels above the floor, S of the scan and R of the point, |S-R|^a = |S|^a + |R|^a - 2 shared, where shared is S R for
/// a = 2 and the overlap for a = 1: only what both sides hear has to be looked at. That runs over LevelBlocks in single precision
/// with a known bound on its rounding; whoever may be among the nearest within the bound is measured again by the definition
/// in double precision, so that nearest() is exact. Immutable, shared.
class RssDistance {
 public:
  RssDistance(std::shared_ptr<const RadioMap> map, const RssDistanceSettings& settings);

  const RadioMap& map() const { return *map_; }

  /// D_j^a of every point to within `bound`, as what it is made of; memory that is kept from scan to scan.
  struct Approximate {
    std::vector<float> shared;     // a point, then up to a whole block; of touched blocks only
    std::vector<float> products;   // wanted for a = 1 only
    std::vector<std::uint8_t> touched;  // a block: it hears something of the scan
    std::vector<float> least;      // a block: the least D_j^a in it
    float scan_alone = 0.0f;       // |S|^a
    float bound = 0.0f;
  };
  void approximate(const KnownScan& scan, Approximate& out) const;

  struct Neighbour {
    std::uint32_t point = 0;
    double powered = 0.0;          ///< D^a, exact
    /// Total, so that ties never depend on the survey's order in memory.
    bool operator<(const Neighbour& other) const {
      return powered != other.powered ? powered < other.powered : point < other.point;
    }
  };
  /// The k nearest points of begin .. end - 1, ascending; `found` is all memory it needs.
  void nearest(const KnownScan& scan, const Approximate& approximate, std::size_t k, std::uint32_t begin, std::uint32_t end,
               std::vector<Neighbour>& found) const;
  float powered(const Approximate& approximate, std::uint32_t point) const {
    const float apart = against_silence_[point] + approximate.scan_alone;
    return approximate.touched[point / LevelBlocks::kBlock] ? apart - 2.0f * approximate.shared[point] : apart;
  }
  /// D_j^a of one point by the definition.
  double powered(const KnownScan& scan, std::uint32_t point) const;
  double root(double powered) const;

 private:
  double power(double difference) const;

  std::shared_ptr<const RadioMap> map_;
  RssDistanceSettings settings_;
  LevelBlocks blocks_;                       // levels above the floor
  std::vector<float> against_silence_;       // a point, then infinite up to a whole block
  std::vector<float> least_against_silence_; // a block
  double most_against_silence_ = 0.0;
};

}  // namespace wayfuse
