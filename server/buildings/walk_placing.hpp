#pragma once

#include <span>
#include <vector>

#include "db/building_database.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// Puts a recorded walk's scans where they were heard.
///
/// Between two marks of one floor the walker went as the motion reports say, turned and stretched so that the way begins and ends
/// at the marks: neither the compass nor the stride need be right, only their shape. Where the motion has no shape to trust (under
/// 1 m, stretched beyond 2, or wound up) the walker went straight, as fast as the steps say. A point just off the walkable area
/// is moved onto it. Readings before the first mark, after the last or between marks of two floors have no place and are left out.
/// Deterministic. `parts` in their order.
std::vector<ReferencePoint> place_walk(std::span<const SurveyWalk> parts, std::span<const Floor> floors);

/// Places every complete walk of the store that is not placed yet. Done again after a break it stores nothing twice: the batches'
/// keys follow from the walk's name. On the store's thread.
Result<void> place_recorded_walks(BuildingDatabase& database);

}  // namespace wayfuse
