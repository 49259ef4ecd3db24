#pragma once

#include <map>
#include <memory>
#include <vector>

#include "db/zone_record.hpp"
#include "server/zones/gaussian_mass.hpp"

namespace wayfuse {

/// A zone made ready for masses.
struct PreparedZone {
  ZoneRecord record;
  std::vector<SignedRing> region;
  std::vector<SignedRing> tolerated;   ///< the region grown by the exit tolerance; empty = the same
  BuildingPoint low, high;             ///< box around the tolerated region
};

/// One building's zones, immutable, by floor.
class ZoneSet {
 public:
  explicit ZoneSet(std::vector<ZoneRecord> zones);

  const std::vector<PreparedZone>& on_floor(FloorOrdinal floor) const;
  const PreparedZone* find(std::uint64_t id) const;
  const std::map<FloorOrdinal, std::vector<PreparedZone>>& floors() const { return floors_; }

 private:
  std::map<FloorOrdinal, std::vector<PreparedZone>> floors_;
};

/// Mass of a position inside a zone: of the plane's Gaussian times the floor's probability.
struct ZoneMass {
  double region = 0.0;
  double tolerated = 0.0;
};
ZoneMass mass_in(const PreparedZone& zone, const FusedPosition& position);

}  // namespace wayfuse
