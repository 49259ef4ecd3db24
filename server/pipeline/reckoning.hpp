#pragma once

#include <numbers>

#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// Dead reckoning in the plane, as both trackers do it.
inline BuildingPoint plus(BuildingPoint a, BuildingPoint b) { return {a.x_m + b.x_m, a.y_m + b.y_m}; }
inline BuildingPoint minus(BuildingPoint a, BuildingPoint b) { return {a.x_m - b.x_m, a.y_m - b.y_m}; }

/// Sigma of a heading nobody knows: of a uniform angle.
inline constexpr double kLostHeadingRad = std::numbers::pi / std::numbers::sqrt3;

}  // namespace wayfuse
