#include "admin/plan/laying_down.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "admin/plan/planar.hpp"

namespace wayfuse {
namespace {

using Coordinates = PlanOptions::Coordinates;
using Severity = PlanCheck::Severity;

constexpr double kSphere_m = 6378137.0;  // EPSG:3857
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMendable_m = 1.0;
constexpr double kSamePoint_m = 0.01;
constexpr double kFarthest_m = 1e5;      // the store's own limit

GeoPoint from_mercator(RawPoint point) {
  return {(2 * std::atan(std::exp(point.y / kSphere_m)) - std::numbers::pi / 2) / kDegree, point.x / kSphere_m / kDegree};
}

template <typename Each>
void for_each_point(const std::vector<const FeatureCollection*>& files, Each&& each) {
  for (const FeatureCollection* file : files) {
    for (const Feature& feature : file->features) {
      for (const auto& polygon : feature.polygons) {
        for (const RawLine& ring : polygon) std::ranges::for_each(ring, each);
      }
      for (const RawLine& line : feature.lines) std::ranges::for_each(line, each);
    }
  }
}

std::string place(BuildingPoint point) {
  char text[64];
  std::snprintf(text, sizeof text, "[%.2f, %.2f]", point.x_m, point.y_m);
  return text;
}

Coordinates guessed(const std::vector<const FeatureCollection*>& files, RawPoint low, RawPoint high, Plan& plan) {
  const auto says = [&](const char* name) {
    return std::ranges::any_of(files, [&](const FeatureCollection* file) { return file->crs.find(name) != std::string::npos; });
  };
  if (says("3857") || says("900913")) {
    plan.check(Severity::kNote, "coordinates", "", "Web Mercator, as the file's crs says");
    return Coordinates::kMercator;
  }
  const bool degrees = low.x >= -180 && high.x <= 180 && low.y >= -90 && high.y <= 90;
  if (degrees) return Coordinates::kWgs84;
  plan.check(Severity::kWarning, "coordinates", "",
             "no degrees: taken as Web Mercator metres; say coordinates=local if they are metres of the building's own frame");
  return Coordinates::kMercator;
}

}  // namespace

LayingDown LayingDown::of(const std::vector<const FeatureCollection*>& files, const PlanOptions& options, Plan& plan) {
  RawPoint low{1e300, 1e300};
  RawPoint high{-1e300, -1e300};
  for_each_point(files, [&](const RawPoint& point) {
    low = {std::min(low.x, point.x), std::min(low.y, point.y)};
    high = {std::max(high.x, point.x), std::max(high.y, point.y)};
  });
  LayingDown laying;
  const bool any = low.x <= high.x;
  laying.coordinates_ = options.coordinates != Coordinates::kGuess ? options.coordinates
                        : any                                      ? guessed(files, low, high, plan)
                                                                   : Coordinates::kWgs84;
  if (laying.coordinates_ == Coordinates::kLocal) {
    plan.georeference = options.georeference;
    return laying;
  }
  if (options.georeference) {
    laying.georeference_ = *options.georeference;
  } else if (any) {
    laying.georeference_.origin =
        laying.coordinates_ == Coordinates::kMercator ? from_mercator(low) : GeoPoint{low.y, low.x};
    plan.check(Severity::kNote, "georeference", "", "made from the plan: origin at its south-west corner, y axis to the north");
  }
  plan.georeference = laying.georeference_;
  return laying;
}

BuildingPoint LayingDown::operator()(RawPoint point) const {
  switch (coordinates_) {
    case Coordinates::kLocal: return {point.x, point.y};
    case Coordinates::kMercator: return georeference_.to_building(from_mercator(point));
    default: return georeference_.to_building(GeoPoint{point.y, point.x});
  }
}

Polyline LayingDown::line(const RawLine& raw) const {
  Polyline line;
  for (const RawPoint& point : raw) line.push_back((*this)(point));
  return line;
}

std::optional<Ring> LayingDown::ring(const RawLine& raw, const std::string& where, Plan& plan) const {
  Ring ring = line(raw);
  const bool far = std::ranges::any_of(ring, [](BuildingPoint p) { return std::abs(p.x_m) > kFarthest_m || std::abs(p.y_m) > kFarthest_m; });
  if (far) {
    plan.check(Severity::kError, "scale", where, "lies more than 100 km from the building's origin: other coordinates than assumed, or another place");
    return std::nullopt;
  }
  if (ring.size() < 3) {
    plan.check(Severity::kError, "open_ring", where, "a ring of " + std::to_string(ring.size()) + " points");
    return std::nullopt;
  }
  const double gap_m = distance_m(ring.front(), ring.back());
  if (gap_m > kMendable_m) {
    char text[128];
    std::snprintf(text, sizeof text, "open by %.2f m between its last point and its first at %s", gap_m, place(ring.front()).c_str());
    plan.check(Severity::kError, "open_ring", where, text);
    return std::nullopt;
  }
  if (gap_m > 0.0) {
    plan.check(Severity::kWarning, "open_ring", where, "open by " + std::to_string(gap_m) + " m at " + place(ring.front()) + "; closed");
  }
  ring.pop_back();
  const auto last = std::unique(ring.begin(), ring.end(), [](BuildingPoint a, BuildingPoint b) { return distance_m(a, b) < kSamePoint_m; });
  ring.erase(last, ring.end());
  if (ring.size() < 3) {
    plan.check(Severity::kWarning, "empty_area", where, "has no area; left out");
    return std::nullopt;
  }
  if (const auto flaw = planar::flaw_of(ring)) {
    plan.check(Severity::kWarning, "self_intersection", where, flaw->what + " at " + place(flaw->at) + "; repaired");
  }
  return ring;
}

Polygon LayingDown::polygon(const Feature& feature, Plan& plan) const {
  Polygon polygon;
  for (const auto& part : feature.polygons) {
    for (const RawLine& raw : part) {
      if (auto sound = ring(raw, feature.where, plan)) polygon.rings.push_back(*std::move(sound));
    }
  }
  return polygon;
}

}  // namespace wayfuse
