#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "wayfuse/proto/fingerprint.hpp"

namespace wayfuse {

/// What a fingerprint says of one transmitter: the scans of the point in which it was heard, summed up.
struct MapLevel {
  std::uint32_t transmitter = 0;   ///< index into RadioMap::transmitters()
  float mean_dbm = 0.0f;           ///< over the readings that heard it; never includes a "not heard"
  float spread_db = 0.0f;          ///< sample standard deviation of those readings, 0 for a single one
  std::uint16_t heard = 0;         ///< scans that heard it, of MapPoint::scans
};

/// One fingerprint of the map.
struct MapPoint {
  Place place;
  std::uint32_t first = 0;         ///< its levels are RadioMap::levels()[first .. first + count)
  std::uint32_t count = 0;
  std::uint16_t scans = 0;
};

/// A scan reduced to what the map knows, ascending by transmitter, each transmitter once.
struct KnownScan {
  struct Level {
    std::uint32_t transmitter = 0;
    float rss_dbm = 0.0f;
    float age_s = 0.0f;
  };
  std::vector<Level> levels;
  int unknown = 0;                 ///< transmitters heard that the map does not know
};

/// The survey as a sparse table: points x transmitters, only what was heard.
///
/// Points stand floor by floor along a space-filling curve, whatever the survey's order: what is near lies together.
/// A transmitter missing from a point is *unknown there*, not a number: every locator says itself what it makes of that.
/// Locally administered addresses that a single point heard are dropped (phones' hot spots pass by), others stay: large networks
/// derive most of theirs that way. Readings that are not finite are dropped.
/// Immutable once built; shared by all sessions.
class RadioMap {
 public:
  /// Every point becomes one fingerprint; its scans are averaged per transmitter. Points without a usable reading are left out.
  static std::shared_ptr<const RadioMap> build(std::span<const ReferencePoint> survey);

  bool empty() const { return points_.empty(); }
  std::span<const MapPoint> points() const { return points_; }
  std::span<const Bssid> transmitters() const { return transmitters_; }
  std::span<const MapLevel> levels() const { return levels_; }
  std::span<const MapLevel> levels(const MapPoint& point) const { return levels().subspan(point.first, point.count); }
  /// Floors that have points, ascending.
  std::span<const FloorOrdinal> floors() const { return floors_; }
  struct Range {
    std::uint32_t begin = 0;       ///< points begin .. end - 1
    std::uint32_t end = 0;
  };
  Range points_on(FloorOrdinal floor) const;
  std::optional<std::uint32_t> index_of(Bssid bssid) const;
  /// Fills `out` without allocating once it has grown. A transmitter read twice counts with its youngest reading.
  void know(const RssScan& scan, KnownScan& out) const;

 private:
  std::vector<MapPoint> points_;
  std::vector<Bssid> transmitters_;  // ascending
  std::vector<MapLevel> levels_;
  std::vector<FloorOrdinal> floors_;
};

/// Whether a reading may enter a map or a fix at all: finite level, a fixed address.
bool usable(const ScanReading& reading);

}  // namespace wayfuse
