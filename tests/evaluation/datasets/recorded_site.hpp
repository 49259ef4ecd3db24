#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sdk/src/recording/import/floor_label.hpp"
#include "sdk/src/recording/import/recorded_walk.hpp"
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
/// known, `geojson_map.json` (first feature the floor's outline, the others shops and rooms) and `floor_info.json`. A map that cannot
/// be used is a complaint, as is a walk whose name another floor has, too.
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

}  // namespace wayfuse
