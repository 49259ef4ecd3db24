#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "db/building_database.hpp"

namespace wayfuse {

/// What a radio map is made of: a version names exactly this, and the same survey and recipe give the same content, byte by byte.
///
/// The content is a small document, not a copy: the survey's rows are never changed, so its version, its hash and what is left
/// out say everything. Points erased later are gone from every version: `whole` tells.
struct MapManifest {
  std::uint64_t points = 0;
  std::uint64_t readings = 0;
  std::string survey_hash;               ///< over every bit of the points, hexadecimal
  std::vector<Bssid> distrusted;         ///< left out of map and likelihood; ascending
  std::map<std::string, double> device_offsets_db;  ///< taken out of a model's readings; learnt when the version was built
  bool operator==(const MapManifest&) const = default;
};
std::string to_content(const MapManifest& manifest);
Result<MapManifest> parse_manifest(std::string_view content);

/// A version with all that a building is made from.
struct MapMaterial {
  std::uint64_t version = 0;             ///< 0 = there is none
  std::uint64_t survey_version = 0;
  std::vector<ReferencePoint> points;
  std::vector<Bssid> distrusted;
  std::map<std::string, double> device_offsets_db;
  std::vector<MapQuality> qualities;     ///< as measured last, walk by walk
  std::map<std::string, std::string> correctors;  ///< by pipeline: what it learnt from this very version before; others learn anew
  bool whole = true;                     ///< false: points were erased since the version was built
};

/// A building's radio maps as versions, over its database. Borrowed for one call, on the store's thread.
class MapVersions {
 public:
  explicit MapVersions(BuildingDatabase& database) : database_(database) {}

  /// Builds a version from the survey as it stands and keeps it; atomic. The same survey and recipe are the same version.
  /// kEmptyRadioMap when there are no points.
  Result<RadioMapRecord> stage(UnixTime now);
  Result<MapMaterial> material(const RadioMapRecord& map);
  /// For a building whose first version could not be written: the survey, under its own version's number.
  Result<MapMaterial> survey_as_it_stands();
  Result<RadioMapRecord> find(std::uint64_t version);
  Result<std::optional<RadioMapRecord>> live();

  /// Whether the building's maps come into force by themselves now: its policy says so, and no operator went back. A rollback,
  /// or an older version promoted by hand, is an operator's word; it holds until the newest version is promoted by hand.
  Result<bool> automatic(const BuildingRecord& building);
  /// Whether there is nothing to do about `map`: it is live, or it was measured and never put in force.
  Result<bool> is_settled(const RadioMapRecord& map);

 private:
  Result<std::vector<ReferencePoint>> points_through(std::uint64_t survey_version);
  BuildingDatabase& database_;
};

}  // namespace wayfuse
