#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "admin/plan/georeference_fit.hpp"
#include "admin/plan/plan.hpp"
#include "db/floor_image.hpp"
#include "db/zone_record.hpp"

/// The JSON of plans, georeferences and floor images.
namespace wayfuse {

/// `{"control_points": [{"x_m":.., "y_m":.., "latitude_deg":.., "longitude_deg":..}, ..]}`.
Result<std::vector<ControlPoint>> parse_control_points(std::string_view json);
std::string to_json(const GeoreferenceFit& fit, bool stored);
/// What was read, checked and, where `stored`, put in place; `zones` are the rooms as zones to be.
std::string to_json(const Plan& plan, const std::vector<Floor>& floors, const std::vector<ZoneRecord>& zones, bool stored);
std::string to_json(const FloorImage& image);

}  // namespace wayfuse
