#include <algorithm>
#include <cmath>

#include "sdk/src/simulator/floor_sketch.hpp"

// One hall: racks of steel with aisles between them, cross aisles at both ends and in the middle.
//
//     +--------------------------------+
//     | S                            L |    S: stairs, L: lift, where there is more than one floor
//     |  ||  ||  ||  ||  ||  ||  ||    |    racks
//     |  ||  ||  ||  ||  ||  ||  ||    |
//     |                                |
//     |  ||  ||  ||  ||  ||  ||  ||    |
//     |                                |
//     +--------------------------------+
namespace wayfuse::simulator {
namespace {

constexpr double kAisle_m = 3.2;
constexpr double kRack_m = 2.0;
constexpr double kEnd_m = 6.0;       // cross aisles along the short walls of the racks
constexpr double kMiddle_m = 3.0;
constexpr double kPick_m = 6.0;      // between places where goods are taken
constexpr double kRack_db = 4.0;     // a face
constexpr double kOuterWall_db = 15.0;

class WarehouseFloor {
 public:
  WarehouseFloor(World& world, FloorOrdinal ordinal, double length_m, double width_m, bool several)
      : sketch_(world, ordinal, length_m, width_m, kOuterWall_db), length_m_(length_m), width_m_(width_m), several_(several) {}

  WorldFloor build() {
    sketch_.walkable({0, 0, length_m_, kEnd_m});
    sketch_.walkable({0, width_m_ - kEnd_m, length_m_, width_m_});
    sketch_.walkable({0, width_m_ / 2 - kMiddle_m / 2, length_m_, width_m_ / 2 + kMiddle_m / 2});
    double x = 0;
    for (; x + kAisle_m <= length_m_; x += kAisle_m + kRack_m) {
      aisle(x);
      if (x + kAisle_m + kRack_m + kAisle_m <= length_m_) rack(x + kAisle_m);
    }
    passages();
    for (auto* stops : {&south_, &middle_, &north_}) sketch_.chain(*stops);
    return sketch_.take();
  }

  std::size_t stairs() const { return stairs_; }
  std::size_t lift() const { return lift_; }
  const std::vector<BuildingPoint>& racks() const { return racks_; }

 private:
  void rack(double x0) {
    for (const auto& [y0, y1] : {std::pair{kEnd_m, width_m_ / 2 - kMiddle_m / 2}, std::pair{width_m_ / 2 + kMiddle_m / 2, width_m_ - kEnd_m}}) {
      sketch_.wall({x0, y0}, {x0, y1}, kRack_db);
      sketch_.wall({x0 + kRack_m, y0}, {x0 + kRack_m, y1}, kRack_db);
      racks_.push_back({x0 + kRack_m / 2, 0.5 * (y0 + y1)});
    }
  }

  void aisle(double x0) {
    sketch_.walkable({x0, kEnd_m - 0.1, x0 + kAisle_m, width_m_ - kEnd_m + 0.1});
    const double x = x0 + kAisle_m / 2;
    std::vector<FloorSketch::Stop> stops;
    for (double y = kEnd_m + kPick_m / 2; y < width_m_ - kEnd_m; y += kPick_m) {
      if (std::abs(y - width_m_ / 2) > kMiddle_m) stops.push_back({y, sketch_.node({x, y}, true)});
    }
    for (const auto& [y, line] : {std::pair{kEnd_m / 2, &south_}, std::pair{width_m_ / 2, &middle_}, std::pair{width_m_ - kEnd_m / 2, &north_}}) {
      const std::size_t crossing = sketch_.node({x, y});
      stops.push_back({y, crossing});
      line->push_back({x, crossing});
    }
    sketch_.chain(stops);
  }

  void passages() {
    if (!several_) return;
    stairs_ = sketch_.node({0.6, width_m_ - kEnd_m / 2}, false, Passage::kStairs);
    lift_ = sketch_.node({length_m_ - 0.6, width_m_ - kEnd_m / 2}, false, Passage::kLift);
    north_.push_back({0.6, stairs_});
    north_.push_back({length_m_ - 0.6, lift_});
  }

  FloorSketch sketch_;
  double length_m_;
  double width_m_;
  bool several_;
  std::vector<FloorSketch::Stop> south_, middle_, north_;
  std::vector<BuildingPoint> racks_;
  std::size_t stairs_ = 0, lift_ = 0;
};

}  // namespace

World make_warehouse(const WorldSettings& settings, Random& random) {
  const int floors = count_within(settings.floors, 1, 1, 5, "floors");
  const double length_m = within(settings.length_m, 90, 40, 200, "length");
  const double width_m = within(settings.width_m, 50, 30, 120, "width");
  const int transmitters = count_within(settings.transmitters_per_floor, 8, 1, 200, "transmitters");
  const int networks = count_within(settings.networks_per_transmitter, 2, 1, 8, "networks");
  World world;
  world.name = "Demo warehouse";
  world.storey_m = 9.0;
  world.seed = random.bits();
  Shaft stairs, lift;
  for (int f = 0; f < floors; ++f) {
    WarehouseFloor floor(world, {f}, length_m, width_m, floors > 1);
    world.floors.push_back(floor.build());
    stairs.nodes.push_back(floor.stairs());
    lift.nodes.push_back(floor.lift());
    // Under the roof, two rows of them.
    for (int i = 0; i < transmitters; ++i) {
      const double x_m = (i + 0.5) / transmitters * length_m, y_m = (i % 2 == 0 ? 0.28 : 0.72) * width_m;
      Transmitter transmitter = transmitter_at({x_m, y_m}, {f}, networks, random);
      transmitter.height_m = 7.5;
      world.transmitters.push_back(std::move(transmitter));
    }
    const int anomalies = count_within(settings.anomalies_per_floor, std::min(100, static_cast<int>(floor.racks().size())), 0, 100, "anomalies");
    for (int i = 0; i < anomalies; ++i) {
      const BuildingPoint rack = floor.racks()[static_cast<std::size_t>(i) % floor.racks().size()];
      MagneticAnomaly steel = anomaly_at({rack.x_m, rack.y_m + 4.0 * random.normal()}, {f}, random);
      steel.strength_ut += 10.0;
      steel.reach_m += 1.0;
      world.anomalies.push_back(steel);
    }
  }
  if (floors > 1) {
    join_floors(world, stairs);
    join_floors(world, lift);
  }
  return world;
}

}  // namespace wayfuse::simulator
