#include "sdk/src/simulator/walker.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse::simulator {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(10);
constexpr double kCorner_m = 0.7;          // corners are cut this far from the node
constexpr double kAcceleration_mps2 = 1.0;
constexpr double kTurn_radps = 2.0;        // how fast a body turns
constexpr double kStairsSpeed_mps = 0.5;
constexpr double kStairsWalk_m = 8.0;

struct Leg {
  BuildingPoint from, to;
  double height0_m, height1_m;
  FloorOrdinal floor0, floor1;
  double length_m;
};

// The polyline through the nodes with its corners cut, as people walk.
std::vector<Leg> legs_through(const World& world, const std::vector<std::size_t>& nodes) {
  std::vector<Leg> legs;
  std::vector<Place> places;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Place here = world.ways[nodes[i]].place;
    if (i == 0 || i + 1 == nodes.size()) {
      places.push_back(here);
      continue;
    }
    for (const std::size_t other : {nodes[i - 1], nodes[i + 1]}) {
      const BuildingPoint to = world.ways[other].place.point;
      const double far_m = distance_m(here.point, to);
      const double cut = far_m > 0 ? std::min(kCorner_m / far_m, 0.4) : 0.0;
      places.push_back({{here.point.x_m + cut * (to.x_m - here.point.x_m), here.point.y_m + cut * (to.y_m - here.point.y_m)},
                        here.floor});
    }
  }
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Place &a = places[i - 1], &b = places[i];
    const double flat_m = distance_m(a.point, b.point);
    const double length_m = a.floor == b.floor ? flat_m : std::max(flat_m, kStairsWalk_m);
    if (length_m < 1e-6) continue;
    legs.push_back({a.point, b.point, a.floor.value * world.storey_m, b.floor.value * world.storey_m, a.floor, b.floor, length_m});
  }
  return legs;
}

double slew(double from, double to, double most) { return from + std::clamp(to - from, -most, most); }

}  // namespace

Walker::Walker(const World& world, const GaitSettings& gait, Duration length, const std::vector<FloorOrdinal>& floors, Random& random) {
  std::vector<std::size_t> rooms;
  for (std::size_t i = 0; i < world.ways.size(); ++i) {
    const bool wanted = floors.empty() || std::ranges::count(floors, world.ways[i].place.floor) > 0;
    if (world.ways[i].room && wanted) rooms.push_back(i);
  }
  std::size_t here = rooms.at(random.below(rooms.size()));
  const Place start = world.ways[here].place;
  stand({start, start.floor.value * world.storey_m, Heading::from_radians(6.28 * random.uniform()), 0, 0}, from_seconds(2));
  while (this->length() < length) {
    const std::size_t next = rooms[random.below(rooms.size())];
    if (next == here) continue;
    walk(world, shortest_way(world, here, next), gait, random);
    here = next;
    if (random.uniform() < gait.pause_share) stand(timeline_.back(), from_seconds(gait.pause_s * (0.5 + random.uniform())));
  }
  timeline_.resize(static_cast<std::size_t>(length / kTick));
}

Walker::Walker(const World& world, const GaitSettings& gait, const std::vector<std::size_t>& nodes, Random& random) {
  const Place start = world.ways[nodes.at(0)].place;
  stand({start, start.floor.value * world.storey_m, Heading{}, 0, 0}, from_seconds(1));
  walk(world, nodes, gait, random);
  stand(timeline_.back(), from_seconds(1));
}

void Walker::stand(const Truth& at, Duration for_time) {
  Truth still = at;
  still.speed_mps = 0.0;
  timeline_.insert(timeline_.end(), static_cast<std::size_t>(for_time / kTick), still);
}

void Walker::walk(const World& world, const std::vector<std::size_t>& nodes, const GaitSettings& gait, Random& random) {
  const std::vector<Leg> legs = legs_through(world, nodes);
  const double dt_s = seconds(kTick);
  double wanted_mps = gait.speed_mps;
  double remaining_m = 0;
  for (const Leg& leg : legs) remaining_m += leg.length_m;
  Truth now = timeline_.back();
  std::size_t tick = 0;
  for (const Leg& leg : legs) {
    const bool stairs = leg.floor0 != leg.floor1;
    const Heading along = stairs && distance_m(leg.from, leg.to) < 1e-6
                              ? now.heading
                              : Heading::from_vector(leg.to.x_m - leg.from.x_m, leg.to.y_m - leg.from.y_m);
    for (double done_m = 0; done_m < leg.length_m;) {
      if (tick++ % 100 == 0) wanted_mps = gait.speed_mps * (1.0 + 0.06 * random.normal());
      const double stop_mps = std::sqrt(2 * kAcceleration_mps2 * std::max(remaining_m, 0.02));
      const double target_mps = std::min({wanted_mps, stop_mps, stairs ? kStairsSpeed_mps : wanted_mps});
      now.speed_mps = std::max(0.1, slew(now.speed_mps, target_mps, kAcceleration_mps2 * dt_s));
      const double advance_m = now.speed_mps * dt_s;
      done_m += advance_m;
      remaining_m -= advance_m;
      const double share = std::min(1.0, done_m / leg.length_m);
      now.place.point = {leg.from.x_m + share * (leg.to.x_m - leg.from.x_m), leg.from.y_m + share * (leg.to.y_m - leg.from.y_m)};
      now.place.floor = share < 0.5 ? leg.floor0 : leg.floor1;
      now.height_m = leg.height0_m + share * (leg.height1_m - leg.height0_m);
      const double turn_rad = along.minus(now.heading);
      now.heading = now.heading.turned_by(std::clamp(turn_rad, -kTurn_radps * dt_s, kTurn_radps * dt_s));
      // People take shorter steps when they walk slower: length grows with the square root of speed.
      const double step_m = gait.step_length_m * std::sqrt(now.speed_mps / gait.speed_mps);
      now.gait_phase += advance_m / step_m;
      timeline_.push_back(now);
    }
  }
}

Truth Walker::at(Duration since_start) const {
  const double ticks = seconds(since_start) / seconds(kTick);
  const auto last = static_cast<double>(timeline_.size() - 1);
  const double clamped = std::clamp(ticks, 0.0, last);
  const auto index = static_cast<std::size_t>(clamped);
  const Truth& a = timeline_[index];
  const Truth& b = timeline_[std::min(index + 1, timeline_.size() - 1)];
  const double share = clamped - static_cast<double>(index);
  Truth truth = a;
  truth.place.point.x_m += share * (b.place.point.x_m - a.place.point.x_m);
  truth.place.point.y_m += share * (b.place.point.y_m - a.place.point.y_m);
  truth.height_m += share * (b.height_m - a.height_m);
  truth.heading = a.heading.turned_by(share * b.heading.minus(a.heading));
  truth.speed_mps += share * (b.speed_mps - a.speed_mps);
  truth.gait_phase += share * (b.gait_phase - a.gait_phase);
  return truth;
}

Duration Walker::length() const { return kTick * static_cast<std::int64_t>(timeline_.size()); }

}  // namespace wayfuse::simulator
