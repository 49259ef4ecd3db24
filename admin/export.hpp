#pragma once

#include <string>

#include "db/building_database.hpp"

namespace wayfuse {

/// Everything an operator put into a building, as a zip archive of formats others read:
/// building.json, plan.geojson (a file `PUT ../plan` takes back), zones.json, points.csv (one row a reading), webhooks.json (without
/// secrets), floor images, quality walks, and a README.txt that says so. What the server made of it, the radio maps, is not in it.
Result<std::string> export_archive(BuildingDatabase& database);

}  // namespace wayfuse
