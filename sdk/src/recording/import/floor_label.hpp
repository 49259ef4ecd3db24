#pragma once

#include <string>
#include <vector>

#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// One ordinal a label, in order, all different: `B2` -2, `B1` -1, `F1` `1F` `L1` `G` 0, `F2` 1. Where a site has a `G`
/// beside an `L1`, the latter is 1. Labels that say nothing get the free ordinals above the top, in alphabetical order.
std::vector<FloorOrdinal> floor_ordinals(const std::vector<std::string>& labels);

}  // namespace wayfuse
