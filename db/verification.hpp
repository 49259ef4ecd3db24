#pragma once

#include "db/building_database.hpp"
#include "db/sqlite.hpp"

namespace wayfuse {

/// Reads every row: pages and indexes, references, packed layouts, each upload against its body hash, counts against scans.
VerifyReport verify_building(SqliteConnection& connection);

}  // namespace wayfuse
