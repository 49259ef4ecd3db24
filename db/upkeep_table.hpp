#pragma once

#include <vector>

#include "db/sqlite.hpp"
#include "db/upkeep_record.hpp"

namespace wayfuse {

/// Of each kind the newest 100 of a building stay. Throws StoreError.
void write_upkeep(SqliteConnection& connection, const UpkeepRecord& record);
std::vector<UpkeepRecord> read_upkeep(SqliteConnection& connection, BuildingId building);  ///< newest first

}  // namespace wayfuse
