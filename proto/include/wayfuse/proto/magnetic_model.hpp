#pragma once

#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// The earth's main magnetic field on the ground at `point`, in the (decimal) year: what a building that has a georeference and no
/// measured field expects phones to sense outside its walls.
///
/// World Magnetic Model 2020 (NOAA/BGS, public domain) up to degree and order 6, drifting linearly: within about 1 degree of
/// declination away from the magnetic poles, from 2015 to 2030; other years count as the nearest of these.
MagneticField main_field(GeoPoint point, double year);

}  // namespace wayfuse
