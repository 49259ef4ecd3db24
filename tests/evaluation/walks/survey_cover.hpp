#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "sdk/src/recording/import/recorded_walk.hpp"

namespace wayfuse {

/// Where the survey walked, to tell covered ground from the rest.
class SurveyCover {
 public:
  static constexpr double kCovered_m = 3.0;
  using Segment = std::pair<BuildingPoint, BuildingPoint>;

  explicit SurveyCover(std::span<const RecordedWalk> survey);
  /// Distance to the nearest survey path on that floor; infinite if there is none.
  double distance_to(Place place) const;
  bool covers(Place place) const { return distance_to(place) <= kCovered_m; }
  const std::vector<Segment>& paths(FloorOrdinal floor) const;

 private:
  std::map<FloorOrdinal, std::vector<Segment>> paths_;
};

}  // namespace wayfuse
