#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/evaluation/datasets/recorded_walk.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// A trace file, not read yet.
struct WalkFile {
  std::string id;
  std::string path;
  FloorOrdinal floor;
  BuildingPoint floor_origin;  ///< of the floor's own frame, in the building's frame
};

/// A building in the layout of "Indoor Location Competition 2.0": `<floor>/path_data_files/*.txt`, and beside them, where
/// known, `geojson_map.json` (first feature the floor's outline, the others shops and rooms) and `floor_info.json`.
///
/// Every floor of that layout has its own frame: metres from the lower left corner of its outline. Here all floors share
/// one, that of the floor nearest to the ground: the others are shifted by where their outlines lie on the earth.
struct RecordedSite {
  std::string name;
  std::optional<Georeference> georeference;  ///< absent without a map
  std::vector<Floor> floors;                 ///< ascending; walkable = the outline without shops and rooms
  std::vector<WalkFile> walks;               ///< ascending by id
  std::vector<std::string> complaints;       ///< what is missing, by file

  const Floor* floor(FloorOrdinal ordinal) const;
};

/// Reads the folder's plans and lists its walks; `only_floors` keeps the floors with these labels (empty = all).
Result<RecordedSite> read_site(const std::string& folder, const std::vector<std::string>& only_floors);

/// One ordinal a label, in order, all different: `B2` -2, `B1` -1, `F1` `1F` `L1` `G` 0, `F2` 1. Where a site has a `G`
/// beside an `L1`, the latter is 1. Labels that say nothing get the free ordinals above the top, in alphabetical order.
std::vector<FloorOrdinal> floor_ordinals(const std::vector<std::string>& labels);

}  // namespace wayfuse
