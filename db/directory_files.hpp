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
/// Removes every file of a building: its database, copies from before migrations, what was put aside.
void remove_building_files(const std::filesystem::path& folder, BuildingId id);
/// Removes copies a migration left beside a database: they hold what was erased since.
void remove_old_copies(const std::filesystem::path& database);
/// Files in passing, and what an earlier process left of them.
std::filesystem::path passing_file(const std::filesystem::path& folder, std::uint64_t number);
void remove_passing_files(const std::filesystem::path& folder);
/// Renames a closed database to a building's file, durably.
void put_in_place(const std::filesystem::path& folder, const std::filesystem::path& database, BuildingId id);

}  // namespace wayfuse
