#pragma once

#include <vector>

#include "db/sqlite.hpp"
#include "db/zone_record.hpp"

namespace wayfuse {

/// Each in one transaction; throw StoreError (kNotFound, kOutOfRange, what the disk says).
std::vector<ZoneRecord> read_zones(SqliteConnection& connection);
ZoneRecord write_zone(SqliteConnection& connection, ZoneRecord zone);
void remove_zone(SqliteConnection& connection, std::uint64_t id);

}  // namespace wayfuse
