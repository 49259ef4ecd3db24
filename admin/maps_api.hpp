#pragma once

#include "admin/map_control.hpp"
#include "admin/router.hpp"
#include "db/database_directory.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Radio maps: versions, comparison, promotion, rollback, publications; quality walks.
void add_map_routes(Router& router, DatabaseDirectory& databases, MapControl& maps);
/// Expected accuracy and survey plan; access points as live traffic hears them.
void add_radio_routes(Router& router, MapControl& maps);

}  // namespace wayfuse
