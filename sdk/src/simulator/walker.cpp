#include "sdk/src/simulator/walker.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/src/simulator/lift_profile.hpp"

namespace wayfuse::simulator {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(10);
constexpr double kCorner_m = 0.7;          // corners are cut this far from the node
constexpr double kAcceleration_mps2 = 1.0;
constexpr double kTurn_radps = 2.0;        // how fast a body turns
constexpr double kStairsSpeed_mps = 0.5;
constexpr double kStairsWalk_m = 8.0;
constexpr double kSwing_s = 0.5;
constexpr double kEscalator_mps = 0.5;     // along its slope
constexpr double kLiftWaitLeast_s = 3.0, kLiftWaitMost_s = 20.0, kLiftDoors_s = 2.0;

double slew(double from, double to, double most) { return from + std::clamp(to - from, -most, most); }

}  // namespace

struct Walker::Leg {
  BuildingPoint from, to;
  double height0_m, height1_m;
  FloorOrdinal floor0, floor1;
  double length_m;          ///< walked or ridden
  Passage passage;          ///< kNone on the level
};

// The polyline through the nodes with its corners cut, as people walk; a lift's storeys in one leg.
std::vector<Walker::Leg> Walker::legs_through(const World& world, const std::vector<std::size_t>& nodes) {
  struct Stop {
    Place place;
    Passage passage;
  };
  std::vector<Stop> stops;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const WayNode& node = world.ways[nodes[i]];
    const Place here = node.place;
    const bool end = i == 0 || i + 1 == nodes.size();
    if (end || world.ways[nodes[i - 1]].place.floor != here.floor || world.ways[nodes[i + 1]].place.floor != here.floor) {
      stops.push_back({here, node.passage});
      continue;
    }
    for (const std::size_t other : {nodes[i - 1], nodes[i + 1]}) {
      const BuildingPoint to = world.ways[other].place.point;
      const double far_m = distance_m(here.point, to);
      const double cut = far_m > 0 ? std::min(kCorner_m / far_m, 0.4) : 0.0;
      stops.push_back({{{here.point.x_m + cut * (to.x_m - here.point.x_m), here.point.y_m + cut * (to.y_m - here.point.y_m)}, here.floor},
                       Passage::kNone});
    }
  }
  std::vector<Leg> legs;
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const Place &a = stops[i - 1].place, &b = stops[i].place;
    const Passage passage = a.floor == b.floor ? Passage::kNone : stops[i].passage;
    const double height0_m = a.floor.value * world.storey_m, height1_m = b.floor.value * world.storey_m;
    if (passage == Passage::kLift && !legs.empty() && legs.back().passage == Passage::kLift) {
      legs.back().to = b.point;
      legs.back().height1_m = height1_m;
      legs.back().floor1 = b.floor;
      continue;
    }
    const double flat_m = distance_m(a.point, b.point);
    const double length_m = passage == Passage::kNone        ? flat_m
                            : passage == Passage::kEscalator ? std::hypot(flat_m, height1_m - height0_m)
                                                             : std::max(flat_m, kStairsWalk_m);
    if (length_m < 1e-6) continue;
    legs.push_back({a.point, b.point, height0_m, height1_m, a.floor, b.floor, length_m, passage});
  }
  return legs;
}

Walker::Walker(const World& world, const GaitSettings& gait, Duration length, const std::vector<FloorOrdinal>& floors, Random& random) {
  std::vector<std::size_t> rooms;
  for (std::size_t i = 0; i < world.ways.size(); ++i) {
    const bool wanted = floors.empty() || std::ranges::count(floors, world.ways[i].place.floor) > 0;
    if (world.ways[i].room && wanted) rooms.push_back(i);
  }
  std::size_t here = rooms.at(random.below(rooms.size()));
  const Place start = world.ways[here].place;
  stand({start, start.floor.value * world.storey_m, Heading::from_radians(6.28 * random.uniform())}, from_seconds(2));
  while (this->length() < length) {
    const std::size_t next = rooms[random.below(rooms.size())];
    if (next == here) continue;
    walk(world, shortest_way(world, here, next), gait, random);
    here = next;
    if (random.uniform() < gait.pause_share) stand(timeline_.back(), from_seconds(gait.pause_s * (0.5 + random.uniform())));
  }
  timeline_.resize(static_cast<std::size_t>(length / kTick));
  swing_arms();
}

Walker::Walker(const World& world, const GaitSettings& gait, const std::vector<std::size_t>& nodes, Random& random) {
  const Place start = world.ways[nodes.at(0)].place;
  stand({start, start.floor.value * world.storey_m, Heading{}}, from_seconds(1));
  walk(world, nodes, gait, random);
  stand(timeline_.back(), from_seconds(1));
  swing_arms();
}

void Walker::stand(const Truth& at, Duration for_time) {
  Truth still = at;
  still.speed_mps = 0.0;
  timeline_.insert(timeline_.end(), static_cast<std::size_t>(for_time / kTick), still);
}

void Walker::walk(const World& world, const std::vector<std::size_t>& nodes, const GaitSettings& gait, Random& random) {
  const std::vector<Leg> legs = legs_through(world, nodes);
  const auto rides = [](const Leg& leg) { return leg.passage == Passage::kEscalator || leg.passage == Passage::kLift; };
  for (std::size_t i = 0; i < legs.size();) {
    const auto ride = std::find_if(legs.begin() + static_cast<std::ptrdiff_t>(i), legs.end(), rides);
    const auto end = static_cast<std::size_t>(ride - legs.begin());
    on_foot(std::span(legs).subspan(i, end - i), gait, random);
    if (ride != legs.end()) ride->passage == Passage::kLift ? ride_lift(world, *ride, random) : ride_escalator(*ride);
    i = end + 1;
  }
}

void Walker::on_foot(std::span<const Leg> legs, const GaitSettings& gait, Random& random) {
  const double dt_s = seconds(kTick);
  double wanted_mps = gait.speed_mps;
  double remaining_m = 0;
  for (const Leg& leg : legs) remaining_m += leg.length_m;
  Truth now = timeline_.back();
  std::size_t tick = 0;
  for (const Leg& leg : legs) {
    const bool stairs = leg.passage == Passage::kStairs;
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

// Stands and is carried: the place moves, the feet do not.
void Walker::ride_escalator(const Leg& leg) {
  const double dt_s = seconds(kTick);
  const Heading along = Heading::from_vector(leg.to.x_m - leg.from.x_m, leg.to.y_m - leg.from.y_m);
  Truth now = timeline_.back();
  now.speed_mps = 0.0;
  for (double done_m = 0; done_m < leg.length_m;) {
    done_m += kEscalator_mps * dt_s;
    const double share = std::min(1.0, done_m / leg.length_m);
    now.place.point = {leg.from.x_m + share * (leg.to.x_m - leg.from.x_m), leg.from.y_m + share * (leg.to.y_m - leg.from.y_m)};
    now.place.floor = share < 0.5 ? leg.floor0 : leg.floor1;
    now.height_m = leg.height0_m + share * (leg.height1_m - leg.height0_m);
    now.heading = now.heading.turned_by(std::clamp(along.minus(now.heading), -kTurn_radps * dt_s, kTurn_radps * dt_s));
    timeline_.push_back(now);
  }
}

// Waits, turns round to face the door, rides as this lift does.
void Walker::ride_lift(const World& world, const Leg& leg, Random& random) {
  stand(timeline_.back(), from_seconds(kLiftWaitLeast_s + (kLiftWaitMost_s - kLiftWaitLeast_s) * random.uniform()));
  const double dt_s = seconds(kTick);
  const double rise_m = leg.height1_m - leg.height0_m, far_m = std::abs(rise_m), sign = rise_m < 0 ? -1.0 : 1.0;
  const LiftProfile lift = LiftProfile::of(lift_at(world, leg.from), far_m);
  const Heading door = timeline_.back().heading.turned_by(3.1);
  Truth now = timeline_.back();
  now.speed_mps = 0.0;
  for (double t_s = 0; t_s < lift.lasts_s(); t_s += dt_s) {
    const double done_m = lift.travelled_m(t_s);
    now.lift_mps2 = sign * lift.acceleration_mps2(t_s);
    now.height_m = leg.height0_m + sign * done_m;
    now.place = {leg.from, done_m < far_m / 2 ? leg.floor0 : leg.floor1};
    now.heading = now.heading.turned_by(std::clamp(door.minus(now.heading), -kTurn_radps * dt_s, kTurn_radps * dt_s));
    timeline_.push_back(now);
  }
  now.lift_mps2 = 0.0;
  now.height_m = leg.height1_m;
  now.place = {leg.to, leg.floor1};
  stand(now, from_seconds(kLiftDoors_s));
}

// Feet start and stop at once, arms and what they hold do not.
void Walker::swing_arms() {
  const double most = seconds(kTick) / kSwing_s;
  double swing = 0.0;
  for (Truth& truth : timeline_) {
    swing = slew(swing, std::min(1.0, truth.speed_mps / 0.5), most);
    truth.swing = swing;
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
  truth.swing += share * (b.swing - a.swing);
  truth.gait_phase += share * (b.gait_phase - a.gait_phase);
  return truth;
}

Duration Walker::length() const { return kTick * static_cast<std::int64_t>(timeline_.size()); }

}  // namespace wayfuse::simulator
