#include <algorithm>
#include <cmath>

#include "sdk/src/simulator/floor_sketch.hpp"

// A ring corridor, rooms on both sides of it, stairs at one end of each floor and a lift at the other:
//
//     +--+--+--+--+--+--+--+--+    rooms
//     |==+==+==+==+==+==+==+==|    corridor
//     | |rooms  |core |rooms| |
//     |S|-------+-----+-----|L|    S: stairs, L: lift
//     |==+==+==+==+==+==+==+==|
//     +--+--+--+--+--+--+--+--+
namespace wayfuse::simulator {
namespace {

constexpr double kRoomDepth_m = 7.0;
constexpr double kCorridor_m = 2.6;
constexpr double kRoomWidth_m = 6.0;
constexpr double kDoor_m = 1.0;
constexpr double kWallThickness_m = 0.2;
constexpr double kInnerWall_db = 4.0;
constexpr double kOuterWall_db = 11.0;
constexpr double kCoreWall_db = 8.0;

class OfficeFloor {
 public:
  OfficeFloor(World& world, FloorOrdinal ordinal, double length_m, double width_m)
      : sketch_(world, ordinal, length_m, width_m, kOuterWall_db), length_m_(length_m), width_m_(width_m) {}

  WorldFloor build() {
    corridors();
    const double inner0 = kRoomDepth_m + kCorridor_m;
    const double inner1 = width_m_ - kRoomDepth_m - kCorridor_m;
    const double middle = 0.5 * (inner0 + inner1);
    room_row(0, 0, length_m_, kRoomDepth_m, true, south_);
    room_row(0, width_m_ - kRoomDepth_m, length_m_, width_m_, false, north_);
    room_row(kCorridor_m, inner0, length_m_ - kCorridor_m, middle, false, south_);
    room_row(kCorridor_m, middle, length_m_ - kCorridor_m, inner1, true, north_);
    sketch_.wall({kCorridor_m, middle}, {length_m_ - kCorridor_m, middle}, kCoreWall_db);
    connect_corridors();
    return sketch_.take();
  }

  std::size_t stairs() const { return stairs_; }
  std::size_t lift() const { return lift_; }

 private:
  void corridors() {
    const double s0 = kRoomDepth_m, s1 = kRoomDepth_m + kCorridor_m;
    const double n0 = width_m_ - kRoomDepth_m - kCorridor_m, n1 = width_m_ - kRoomDepth_m;
    for (const Box box : {Box{0, s0, length_m_, s1}, Box{0, n0, length_m_, n1}, Box{0, s0, kCorridor_m, n1},
                          Box{length_m_ - kCorridor_m, s0, length_m_, n1}}) {
      sketch_.walkable(box);
    }
    sketch_.wall({kCorridor_m, s1}, {kCorridor_m, n0}, kCoreWall_db);
    sketch_.wall({length_m_ - kCorridor_m, s1}, {length_m_ - kCorridor_m, n0}, kCoreWall_db);
  }

  // A row of rooms between y0 and y1, their doors on the upper or the lower side.
  void room_row(double x0, double y0, double x1, double y1, bool doors_above, std::vector<FloorSketch::Stop>& corridor) {
    const int rooms = std::max(1, static_cast<int>(std::round((x1 - x0) / kRoomWidth_m)));
    const double width_m = (x1 - x0) / rooms;
    const double door_y = doors_above ? y1 : y0;
    const double corridor_y = door_y + (doors_above ? 0.5 : -0.5) * kCorridor_m;
    for (int i = 0; i < rooms; ++i) {
      const double a = x0 + i * width_m, b = a + width_m, door = 0.5 * (a + b);
      const double t = 0.5 * kWallThickness_m;
      sketch_.walkable({a + t, y0 + t, b - t, y1 - t});
      sketch_.walkable({door - kDoor_m / 2, door_y - 0.3, door + kDoor_m / 2, door_y + 0.3});
      if (i > 0) sketch_.wall({a, y0}, {a, y1}, kInnerWall_db);
      sketch_.wall_with_door(a, b, door_y, door, kDoor_m, kInnerWall_db);
      const std::size_t centre = sketch_.node({door, 0.5 * (y0 + y1)}, true);
      const std::size_t outside = sketch_.node({door, corridor_y});
      sketch_.join(centre, outside);
      corridor.push_back({door, outside});
    }
  }

  void connect_corridors() {
    const double y_south = kRoomDepth_m + kCorridor_m / 2, y_north = width_m_ - y_south;
    const double x_west = kCorridor_m / 2, x_east = length_m_ - x_west;
    const std::size_t sw = sketch_.node({x_west, y_south}), se = sketch_.node({x_east, y_south});
    const std::size_t nw = sketch_.node({x_west, y_north}), ne = sketch_.node({x_east, y_north});
    stairs_ = sketch_.node({x_west, width_m_ / 2}, false, Passage::kStairs);
    const std::size_t before_lift = sketch_.node({x_east, width_m_ / 2});
    lift_ = sketch_.node({length_m_ - 0.6, width_m_ / 2}, false, Passage::kLift);
    south_.push_back({x_west, sw});
    south_.push_back({x_east, se});
    north_.push_back({x_west, nw});
    north_.push_back({x_east, ne});
    sketch_.chain(south_);
    sketch_.chain(north_);
    sketch_.join(sw, stairs_);
    sketch_.join(stairs_, nw);
    sketch_.join(se, before_lift);
    sketch_.join(before_lift, ne);
    sketch_.join(before_lift, lift_);
  }

  FloorSketch sketch_;
  double length_m_;
  double width_m_;
  std::vector<FloorSketch::Stop> south_;
  std::vector<FloorSketch::Stop> north_;
  std::size_t stairs_ = 0;
  std::size_t lift_ = 0;
};

}  // namespace

World make_office(const WorldSettings& settings, Random& random) {
  const int floors = count_within(settings.floors, 2, 1, 20, "floors");
  const double length_m = within(settings.length_m, 60, 40, 200, "length");
  const double width_m = within(settings.width_m, 32, 28, 60, "width");
  const int transmitters = count_within(settings.transmitters_per_floor, 9, 1, 200, "transmitters");
  const int networks = count_within(settings.networks_per_transmitter, 2, 1, 8, "networks");
  const int anomalies = count_within(settings.anomalies_per_floor, 6, 0, 100, "anomalies");
  World world;
  world.name = "Demo office";
  world.seed = random.bits();
  Shaft stairs, lift;
  for (int f = 0; f < floors; ++f) {
    OfficeFloor floor(world, {f}, length_m, width_m);
    world.floors.push_back(floor.build());
    stairs.nodes.push_back(floor.stairs());
    lift.nodes.push_back(floor.lift());
  }
  join_floors(world, stairs);
  join_floors(world, lift);
  // Access points stand in a jittered lattice along both corridors, as installers put them.
  for (int f = 0; f < floors; ++f) {
    for (int i = 0; i < transmitters; ++i) {
      const double share = (i + 0.5) / transmitters;
      const double lane = (i + f) % 3 == 0 ? 0.5 : (i + f) % 3 == 1 ? 0.26 : 0.74;
      const double x_m = std::clamp(share * length_m + 2.0 * random.normal(), 1.0, length_m - 1.0);
      const double y_m = std::clamp(lane * width_m + 1.5 * random.normal(), 1.0, width_m - 1.0);
      world.transmitters.push_back(transmitter_at({x_m, y_m}, {f}, networks, random));
    }
  }
  for (int f = 0; f < floors; ++f) {
    for (int i = 0; i < anomalies; ++i) {
      const double x_m = random.uniform() * length_m;
      world.anomalies.push_back(anomaly_at({x_m, random.uniform() * width_m}, {f}, random));
    }
  }
  return world;
}

}  // namespace wayfuse::simulator
