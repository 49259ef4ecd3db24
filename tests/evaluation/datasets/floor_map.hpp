#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// A point on the Web-Mercator plane (EPSG:3857), in its own stretched metres.
struct MercatorPoint {
  double x = 0.0;
  double y = 0.0;
};
MercatorPoint to_mercator(GeoPoint point);
GeoPoint to_geo(MercatorPoint point);

/// A floor's plan in the floor's own frame: metres, the origin at the lower left corner of the outline's bounding box, x to
/// the east, y to the north.
///
/// The maps are drawn on the Web-Mercator plane; `floor_info.json` tells the true width of the outline, and so the scale. Where it
/// contradicts the outline's latitude by more than a fifth, the latitude counts: unless width and height have the outline's
/// proportions, and the floor's way points lie inside it at that scale and are not lost in it. Outside at either scale: no outline.
struct FloorMap {
  Polygon outline;                      ///< empty = no map
  Polygon walkable;                     ///< the outline with shops and rooms cut out
  std::optional<MercatorPoint> corner;  ///< where the origin lies
  double metres_per_unit = 1.0;         ///< of the Mercator plane

  GeoPoint corner_geo() const;  ///< precondition: there is a corner
  BuildingPoint corner_seen_from(const FloorMap& other) const;
};

/// Reads `geojson_map.json` and `floor_info.json`. The outline is the first feature, or if another one is larger and surrounds the
/// rest, that one. What is missing, broken or odd is a complaint that names the file; without an outline the map is empty.
/// `way_points`, in the floor's frame, are asked for only where the scale is in doubt.
FloorMap read_floor_map(const std::string& folder, std::vector<std::string>& complaints,
                        const std::function<std::vector<BuildingPoint>()>& way_points);

/// Shifts outline and walkable area.
void move_by(Floor& floor, BuildingPoint offset);

}  // namespace wayfuse
