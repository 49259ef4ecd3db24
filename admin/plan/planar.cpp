#include "admin/plan/planar.hpp"

#include <geos_c.h>

#include <cstdint>
#include <memory>

namespace wayfuse::planar {
namespace {

/// One context a thread: GEOS wants it so, and making one for each call would cost more than most calls.
class Geos {
 public:
  Geos() : context_(GEOS_init_r()) {}  // without handlers: GEOS stays silent
  ~Geos() { GEOS_finish_r(context_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;
  GEOSContextHandle_t get() const { return context_; }

 private:
  GEOSContextHandle_t context_;
};

GEOSContextHandle_t context() {
  static thread_local const Geos geos;
  return geos.get();
}

struct Destroy {
  void operator()(GEOSGeometry* geometry) const { GEOSGeom_destroy_r(context(), geometry); }
};
using Shape = std::unique_ptr<GEOSGeometry, Destroy>;

Shape nothing() { return Shape(GEOSGeom_createEmptyPolygon_r(context())); }
/// GEOS answers null where it failed: nothing.
Shape sure(GEOSGeometry* made) { return made ? Shape(made) : nothing(); }

GEOSCoordSequence* sequence_of(const std::vector<BuildingPoint>& points, bool closed) {
  const auto count = static_cast<unsigned>(points.size() + (closed ? 1 : 0));
  GEOSCoordSequence* sequence = GEOSCoordSeq_create_r(context(), count, 2);
  for (unsigned i = 0; i < count; ++i) {
    const BuildingPoint& point = points[i % points.size()];
    GEOSCoordSeq_setXY_r(context(), sequence, i, point.x_m, point.y_m);
  }
  return sequence;
}

// As drawn, sound or not; null for fewer than three points.
Shape drawn(const Ring& ring) {
  if (ring.size() < 3) return nullptr;
  GEOSGeometry* shell = GEOSGeom_createLinearRing_r(context(), sequence_of(ring, true));
  return Shape(shell ? GEOSGeom_createPolygon_r(context(), shell, nullptr, 0) : nullptr);
}

Shape sound(const Ring& ring) {
  Shape shape = drawn(ring);
  if (!shape) return nothing();
  if (GEOSisValid_r(context(), shape.get()) == 1) return shape;
  return sure(GEOSMakeValid_r(context(), shape.get()));
}

Shape shape_of(const Polygon& polygon) {
  Shape shape = nothing();
  for (const Ring& ring : polygon.rings) shape = sure(GEOSSymDifference_r(context(), shape.get(), sound(ring).get()));
  return shape;
}

Shape shape_of(const Polyline& line) {
  if (line.size() < 2) return nothing();
  return sure(GEOSGeom_createLineString_r(context(), sequence_of(line, false)));
}

std::vector<BuildingPoint> points_of(const GEOSGeometry* line, bool closed) {
  std::vector<BuildingPoint> points;
  const GEOSCoordSequence* sequence = GEOSGeom_getCoordSeq_r(context(), line);
  unsigned count = 0;
  if (!sequence || !GEOSCoordSeq_getSize_r(context(), sequence, &count)) return points;
  for (unsigned i = 0; i + (closed ? 1 : 0) < count; ++i) {
    BuildingPoint point;
    GEOSCoordSeq_getXY_r(context(), sequence, i, &point.x_m, &point.y_m);
    points.push_back(point);
  }
  return points;
}

template <typename Each>
void for_each_part(const GEOSGeometry* shape, Each&& each) {
  const int count = GEOSGetNumGeometries_r(context(), shape);
  for (int i = 0; i < count; ++i) {
    const GEOSGeometry* part = GEOSGetGeometryN_r(context(), shape, i);
    if (part != shape && GEOSGetNumGeometries_r(context(), part) > 1) {
      for_each_part(part, each);
    } else {
      each(part);
    }
  }
}

std::vector<std::pair<Ring, bool>> rings_of(const Shape& shape) {
  std::vector<std::pair<Ring, bool>> rings;
  for_each_part(shape.get(), [&](const GEOSGeometry* part) {
    if (GEOSGeomTypeId_r(context(), part) != GEOS_POLYGON || GEOSisEmpty_r(context(), part)) return;
    rings.emplace_back(points_of(GEOSGetExteriorRing_r(context(), part), true), false);
    const int holes = GEOSGetNumInteriorRings_r(context(), part);
    for (int i = 0; i < holes; ++i) rings.emplace_back(points_of(GEOSGetInteriorRingN_r(context(), part, i), true), true);
  });
  return rings;
}

Polygon polygon_of(const Shape& shape) {
  Polygon polygon;
  for (auto& [ring, hole] : rings_of(shape)) polygon.rings.push_back(std::move(ring));
  return polygon;
}

double area_of(const Shape& shape) {
  double area = 0.0;
  return GEOSArea_r(context(), shape.get(), &area) ? area : 0.0;
}

Shape collected(std::vector<Shape> shapes) {
  std::vector<GEOSGeometry*> parts;
  for (Shape& shape : shapes) parts.push_back(shape.release());
  return sure(GEOSGeom_createCollection_r(context(), GEOS_GEOMETRYCOLLECTION, parts.data(), static_cast<unsigned>(parts.size())));
}

Shape together(std::vector<Shape> shapes) {
  if (shapes.empty()) return nothing();
  return sure(GEOSUnaryUnion_r(context(), collected(std::move(shapes)).get()));
}

constexpr int kChordsAQuarter = 4;
constexpr double kSameLine_m = 0.01;  // edges of neighbours are rarely drawn to the same bit

}  // namespace

std::optional<Flaw> flaw_of(const Ring& ring) {
  const Shape shape = drawn(ring);
  if (!shape) return Flaw{"fewer than three points", ring.empty() ? BuildingPoint{} : ring.front()};
  char* reason = nullptr;
  GEOSGeometry* where = nullptr;
  const char valid = GEOSisValidDetail_r(context(), shape.get(), 0, &reason, &where);
  Flaw flaw{reason ? reason : "not a sound ring", ring.front()};
  if (where) {
    GEOSGeomGetX_r(context(), where, &flaw.at.x_m);
    GEOSGeomGetY_r(context(), where, &flaw.at.y_m);
    GEOSGeom_destroy_r(context(), where);
  }
  if (reason) GEOSFree_r(context(), reason);
  return valid == 1 ? std::nullopt : std::optional(flaw);
}

std::vector<std::pair<Ring, bool>> outlines_of(const Polygon& polygon) { return rings_of(shape_of(polygon)); }

double area_m2(const Polygon& polygon) { return area_of(shape_of(polygon)); }

Polygon grown(const Polygon& polygon, double by_m) {
  return polygon_of(sure(GEOSBuffer_r(context(), shape_of(polygon).get(), by_m, kChordsAQuarter)));
}

Polygon united(const std::vector<Polygon>& polygons) {
  std::vector<Shape> shapes;
  for (const Polygon& polygon : polygons) shapes.push_back(shape_of(polygon));
  return polygon_of(together(std::move(shapes)));
}

Polygon without(const Polygon& from, const Polygon& taken) {
  return polygon_of(sure(GEOSDifference_r(context(), shape_of(from).get(), shape_of(taken).get())));
}

Polygon both(const Polygon& a, const Polygon& b) {
  return polygon_of(sure(GEOSIntersection_r(context(), shape_of(a).get(), shape_of(b).get())));
}

double share_within(const Polygon& part, const Polygon& whole) {
  const Shape shape = shape_of(part);
  const double area = area_of(shape);
  if (area <= 0.0) return 0.0;
  return area_of(sure(GEOSIntersection_r(context(), shape.get(), shape_of(whole).get()))) / area;
}

double distance_m(const Polygon& polygon, const Polyline& line) {
  double distance = 0.0;
  const Shape border = sure(GEOSBoundary_r(context(), shape_of(polygon).get()));
  return GEOSDistance_r(context(), border.get(), shape_of(line).get(), &distance) ? distance : 0.0;
}

std::vector<Polyline> borders(const std::vector<Polygon>& polygons, const std::vector<Polyline>& openings, double gap_m) {
  std::vector<Shape> lines;
  for (const Polygon& polygon : polygons) lines.push_back(sure(GEOSBoundary_r(context(), shape_of(polygon).get())));
  std::vector<Shape> gaps;
  for (const Polyline& opening : openings) gaps.push_back(sure(GEOSBuffer_r(context(), shape_of(opening).get(), gap_m, kChordsAQuarter)));
  Shape walls = sure(GEOSUnaryUnionPrec_r(context(), collected(std::move(lines)).get(), kSameLine_m));
  if (!gaps.empty()) walls = sure(GEOSDifference_r(context(), walls.get(), together(std::move(gaps)).get()));
  walls = sure(GEOSLineMerge_r(context(), walls.get()));
  std::vector<Polyline> found;
  for_each_part(walls.get(), [&](const GEOSGeometry* part) {
    const int type = GEOSGeomTypeId_r(context(), part);
    if ((type == GEOS_LINESTRING || type == GEOS_LINEARRING) && !GEOSisEmpty_r(context(), part)) found.push_back(points_of(part, false));
  });
  return found;
}

}  // namespace wayfuse::planar
