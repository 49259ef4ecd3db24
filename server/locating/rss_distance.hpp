#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/locating/radio_map.hpp"

namespace wayfuse {

struct RssDistanceSettings {
  double exponent = 2.0;           ///< a of [P2]: 1 Manhattan, 2 Euclidean as [P1 eq. 1]
  double floor_dbm = -100.0;       ///< level assumed for a transmitter heard on one side only
};

/// Minkowski distances in signal space from one scan to every point of a map.
///
/// D_j = (sum_i |rss_i - RSS_ji|^a)^(1/a) over every transmitter the map knows that is heard in the scan, at the point, or
/// both [P1 eq. 1, P2]; heard on one side only counts as `floor_dbm` on the other. Transmitters the map does not know
/// count nowhere: they add the same to every D_j^a.
///
/// Exact and sparse: D_j^a = |point j against silence| + sum over the scan of (|s-r|^a - |r-floor|^a) where j hears it, else
/// |s-floor|^a; an inverted index touches only the points that hear something in common. Immutable, shared.
class RssDistance {
 public:
  RssDistance(std::shared_ptr<const RadioMap> map, const RssDistanceSettings& settings);

  const RadioMap& map() const { return *map_; }
  /// Writes D_j^a, no root taken, for every point; `out` has one entry a point.
  void powered(const KnownScan& scan, std::span<double> out) const;
  double root(double powered) const;

 private:
  double power(double difference) const;
  template <typename Power>
  void accumulate(const KnownScan& scan, std::span<double> out, const Power& power) const;

  struct Heard {
    std::uint32_t point;
    float mean_dbm;
  };
  std::shared_ptr<const RadioMap> map_;
  RssDistanceSettings settings_;
  std::vector<double> against_silence_;      // a point
  std::vector<std::uint32_t> first_heard_;   // a transmitter, and one past the end
  std::vector<Heard> heard_;
};

}  // namespace wayfuse
