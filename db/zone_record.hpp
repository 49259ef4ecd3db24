#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// A polygon on a floor whose entries and exits are told. The tolerances are omlox's; absent = infinite.
struct ZoneRecord {
  std::uint64_t id = 0;                          ///< 0 = not stored yet; a number is never given twice
  std::string name;
  FloorOrdinal floor;
  Polygon region;                                ///< rings of at least three points, metres
  double exit_tolerance_m = 0.0;                 ///< outside by less than this is still inside, for `tolerance_timeout`
  std::optional<Duration> tolerance_timeout = Duration{0};
  std::optional<Duration> exit_delay = Duration{0};   ///< an exit is told this long after it began
  std::optional<Duration> timeout;               ///< without a position for this long counts as an exit
  bool operator==(const ZoneRecord&) const = default;
};

}  // namespace wayfuse
