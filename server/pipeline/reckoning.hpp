#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// Dead reckoning in the plane, as both trackers do it.
inline BuildingPoint plus(BuildingPoint a, BuildingPoint b) { return {a.x_m + b.x_m, a.y_m + b.y_m}; }
inline BuildingPoint minus(BuildingPoint a, BuildingPoint b) { return {a.x_m - b.x_m, a.y_m - b.y_m}; }

/// Sigma of a heading nobody knows: of a uniform angle.
inline constexpr double kLostHeadingRad = std::numbers::pi / std::numbers::sqrt3;
/// What a position may state, or it would be withheld as impossible: nobody knows less of a heading than nothing, and a speed that a filter
/// made of nonsense is as fast as the protocol goes.
inline double stated_heading_sigma_rad(double sigma_rad) { return std::min(sigma_rad, kLostHeadingRad); }
inline double stated_speed_mps(double speed_mps) { return std::min(speed_mps, 100.0); }

/// Of a point in a pipeline's frame: nobody walks farther from the building, and no message takes a place beyond 100 km. False for what
/// is no number.
inline bool is_near(BuildingPoint point) { return std::abs(point.x_m) < 90e3 && std::abs(point.y_m) < 90e3; }

/// Longer without a known access point is no throttling: a phone's system lets an application in the foreground scan once in 30 s.
inline constexpr double kStaleScanS = 40.0;
inline constexpr const char* kStaleWords = "no known access point was heard for 40 s";

}  // namespace wayfuse
