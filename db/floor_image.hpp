#pragma once

#include <cstdint>
#include <string>

#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// A floor's picture, as it came, and where it lies on the plan.
struct FloorImage {
  FloorOrdinal floor;
  std::string media_type;                ///< `image/png` or `image/jpeg`
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  BuildingPoint origin;                  ///< of its lower left corner
  double width_m = 0.0;
  double height_m = 0.0;
  double azimuth_rad = 0.0;              ///< of its upward edge, clockwise from the y axis
  std::string content;
  bool operator==(const FloorImage&) const = default;
};

}  // namespace wayfuse
