#include "tests/evaluation/walks/survey_cover.hpp"

#include <algorithm>
#include <limits>

namespace wayfuse {
namespace {

double distance_to_segment_m(BuildingPoint p, const SurveyCover::Segment& segment) {
  const auto& [a, b] = segment;
  const double dx = b.x_m - a.x_m;
  const double dy = b.y_m - a.y_m;
  const double square = dx * dx + dy * dy;
  const double along = square == 0.0 ? 0.0 : ((p.x_m - a.x_m) * dx + (p.y_m - a.y_m) * dy) / square;
  const double t = std::clamp(along, 0.0, 1.0);
  return distance_m(p, {a.x_m + t * dx, a.y_m + t * dy});
}

}  // namespace

SurveyCover::SurveyCover(std::span<const RecordedWalk> survey) {
  for (const RecordedWalk& walk : survey) {
    auto& segments = paths_[walk.floor];
    if (walk.way_points.size() == 1) segments.emplace_back(walk.way_points[0].point, walk.way_points[0].point);
    for (std::size_t i = 1; i < walk.way_points.size(); ++i) {
      segments.emplace_back(walk.way_points[i - 1].point, walk.way_points[i].point);
    }
  }
}

double SurveyCover::distance_to(Place place) const {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Segment& segment : paths(place.floor))
    nearest_m = std::min(nearest_m, distance_to_segment_m(place.point, segment));
  return nearest_m;
}

const std::vector<SurveyCover::Segment>& SurveyCover::paths(FloorOrdinal floor) const {
  static const std::vector<Segment> kNone;
  const auto found = paths_.find(floor);
  return found == paths_.end() ? kNone : found->second;
}

}  // namespace wayfuse
