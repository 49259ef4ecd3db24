#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "wayfuse/proto/place.hpp"

/// Plane geometry of floor plans, by GEOS. Areas in square metres, lengths in metres, the building's frame; a polygon is what
/// the even-odd rule makes of its rings. Functions of their arguments; rings GEOS cannot repair count as nothing.
namespace wayfuse::planar {

/// What is wrong with a ring, in GEOS's words (`Self-intersection`), and where.
struct Flaw {
  std::string what;
  BuildingPoint at;
};
std::optional<Flaw> flaw_of(const Ring& ring);

/// The polygon's rings, each with whether it takes area away; rings that touch or cross are resolved.
std::vector<std::pair<Ring, bool>> outlines_of(const Polygon& polygon);

double area_m2(const Polygon& polygon);
/// All points within `by_m` of the polygon; round corners of 16 chords a circle.
Polygon grown(const Polygon& polygon, double by_m);
/// What several polygons cover together.
Polygon united(const std::vector<Polygon>& polygons);
Polygon without(const Polygon& from, const Polygon& taken);
Polygon both(const Polygon& a, const Polygon& b);
/// How much of `part`'s area lies in `whole`, 0..1; 0 if it has none.
double share_within(const Polygon& part, const Polygon& whole);
double distance_m(const Polygon& polygon, const Polyline& line);

/// The borders of these polygons as lines, each once, without what lies within `gap_m` of an opening.
std::vector<Polyline> borders(const std::vector<Polygon>& polygons, const std::vector<Polyline>& openings, double gap_m);

}  // namespace wayfuse::planar
