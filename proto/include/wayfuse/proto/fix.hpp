#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wayfuse/proto/heading.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// An absolute position from one source, before fusion.
struct Fix {
  Place place;
  double sigma_m = 0.0;            ///< per axis
  int transmitters = 0;            ///< known access points that spoke for it
  bool operator==(const Fix&) const = default;
};

/// Of a position in the plane, square metres.
struct Covariance {
  double xx_m2 = 0.0;
  double xy_m2 = 0.0;
  double yy_m2 = 0.0;
  bool operator==(const Covariance&) const = default;
};

struct FloorProbability {
  FloorOrdinal floor;
  double probability = 0.0;
  bool operator==(const FloorProbability&) const = default;
};

/// Whether the radio evidence may be believed [SAFETY C26].
enum class Integrity : std::uint8_t { kOk, kDegraded, kSuspect };

/// What went into a position.
struct Contributions {
  int transmitters_used = 0;       ///< known access points in the newest scan applied
  int transmitters_unknown = 0;    ///< heard there, not on the map
  Duration scan_age{0};            ///< since the newest reading applied was heard
  int steps_since_scan = 0;        ///< dead reckoning since then
  bool gnss = false;
  bool operator==(const Contributions&) const = default;
};

/// A fused position: where, when, how sure, and on what grounds.
struct FusedPosition {
  PhoneTime valid_at;              ///< on the phone's own clock
  BuildingId building;
  Place place;
  std::optional<GeoPoint> geo;     ///< where the building is georeferenced
  std::vector<FloorProbability> floors;   ///< descending, sums to 1
  Covariance covariance;
  double radius68_m = 0.0;         ///< the truth lies inside 68 % of the time
  double radius95_m = 0.0;
  Heading heading;                 ///< of the walker, local frame
  double heading_sigma_rad = 0.0;
  double speed_mps = 0.0;
  std::uint64_t radio_map_version = 0;
  Integrity integrity = Integrity::kOk;
  Contributions from;
  bool operator==(const FusedPosition&) const = default;
};

}  // namespace wayfuse
