#pragma once

#include <filesystem>
#include <set>

#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// The files of a data folder. A building's path comes from its number, never from a name [C2].
std::filesystem::path building_file(const std::filesystem::path& folder, BuildingId id);

struct DirectoryFiles {
  std::set<BuildingId> buildings;
  std::set<BuildingId> corrupt;    ///< put aside earlier, and no newer file in their place
};

/// Makes the folder, readable by its owner only, when it is missing; else lists it. Throws StoreError.
DirectoryFiles list_or_make(const std::filesystem::path& folder);

/// Renames a building's database and log to `.corrupt`, `.corrupt-2`, ...: nothing is thrown away.
void put_aside(const std::filesystem::path& folder, BuildingId id);
/// Removes a database with its log and marks; a file that is not there is no fault.
void remove_database(const std::filesystem::path& file);
/// Renames a closed database to a building's file, durably.
void put_in_place(const std::filesystem::path& folder, const std::filesystem::path& database, BuildingId id);

}  // namespace wayfuse
