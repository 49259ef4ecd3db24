#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "wayfuse/proto/heading.hpp"

namespace wayfuse {

/// A building's number. 0 = none: to be resolved from the access points heard.
struct BuildingId {
  std::uint64_t value = 0;
  auto operator<=>(const BuildingId&) const = default;
};

/// A floor's ordinal as in IMDF: 0 = ground, negative below. Its label (`B1`, `Mezzanine`) is for people only.
struct FloorOrdinal {
  std::int32_t value = 0;
  auto operator<=>(const FloorOrdinal&) const = default;
};

/// A point in the building's local frame, metres: x east-ish, y north-ish (see Georeference).
struct BuildingPoint {
  double x_m = 0.0;
  double y_m = 0.0;
  bool operator==(const BuildingPoint&) const = default;
};

double distance_m(BuildingPoint a, BuildingPoint b);

/// A point on a floor.
struct Place {
  BuildingPoint point;
  FloorOrdinal floor;
  bool operator==(const Place&) const = default;
};

/// WGS84, degrees.
struct GeoPoint {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  bool operator==(const GeoPoint&) const = default;
};

/// How the local frame lies on the earth: the one place that converts between the two.
///
/// A tangent plane at `origin` with WGS84's local radii of curvature: within 1 cm over 5 km.
struct Georeference {
  GeoPoint origin;                   ///< of the local (0, 0)
  double y_axis_azimuth_rad = 0.0;   ///< true azimuth of the local y axis, clockwise from north
  bool operator==(const Georeference&) const = default;

  GeoPoint to_geo(BuildingPoint point) const;
  BuildingPoint to_building(GeoPoint point) const;
  /// A heading measured against true (east, north) axes, turned into the local frame; and back.
  Heading to_building(Heading true_heading) const;
  Heading to_true(Heading building_heading) const;
};

/// A closed ring without a repeated last point, metres.
using Ring = std::vector<BuildingPoint>;
/// An open line, metres.
using Polyline = std::vector<BuildingPoint>;
/// Outer ring first, then holes.
struct Polygon {
  std::vector<Ring> rings;
  bool operator==(const Polygon&) const = default;
};
/// Even-odd rule over all rings; a point on the edge may fall on either side.
bool contains(const Polygon& polygon, BuildingPoint point);

struct Floor {
  FloorOrdinal ordinal;
  std::string label;
  Polygon outline;                  ///< empty = unknown
  std::vector<Polygon> walkable;    ///< union; empty = everywhere inside the outline
  std::vector<Polyline> walls = {}; ///< doors are gaps between them; empty = none are known
  bool operator==(const Floor&) const = default;
};

/// The local magnetic field, for the phone's compass.
struct MagneticField {
  double declination_rad = 0.0;     ///< magnetic north minus true north, clockwise positive
  double dip_rad = 0.0;             ///< below the horizon positive
  double norm_ut = 0.0;             ///< microtesla; 0 = unknown
  bool operator==(const MagneticField&) const = default;
};

}  // namespace wayfuse
