#pragma once

#include <vector>

#include "db/floor_image.hpp"
#include "db/sqlite.hpp"

namespace wayfuse {

/// Each in one transaction; throw StoreError.
void write_floor_image(SqliteConnection& connection, const FloorImage& image);
FloorImage read_floor_image(SqliteConnection& connection, FloorOrdinal floor);
std::vector<FloorOrdinal> read_floors_with_image(SqliteConnection& connection);
void remove_floor_image(SqliteConnection& connection, FloorOrdinal floor);

}  // namespace wayfuse
