#pragma once

#include "server/buildings/building_keeper.hpp"
#include "server/quality/map_comparison.hpp"

namespace wayfuse {

/// The stored recordings made ready for replaying. One that cannot be read any more is left out and named in `remarks`.
std::vector<QualityWalk> read_walks(const std::vector<StoredQualityWalk>& walks, const MagneticField& field, std::vector<std::string>& remarks);

/// The gate before a map comes into force by itself: both maps are replayed with the building's own pipeline, and only a
/// candidate that is worse is held back. `live` null or mapless: published.
MapJudgement judge_map(const Building& candidate, const Building* live, const std::vector<StoredQualityWalk>& walks, UnixTime now);

}  // namespace wayfuse
