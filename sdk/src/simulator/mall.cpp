#include <algorithm>
#include <cmath>

#include "sdk/src/simulator/floor_sketch.hpp"

// Shops round a ring of concourses, an atrium through all floors in the middle, shops on both sides of it:
//
//     +---+----+--+-----+---+----+--+----+    shops, glass fronts
//     |==================E===E===========|    concourse, E: escalators
//     |   |shop|shop|          |shop|    |
//     |L  |----+----|  atrium  |----+-- S|    L: lift, S: stairs; a bridge crosses the atrium above the ground
//     |   |shop|shop|          |shop|    |
//     |==================================|
//     +--+-----+---+----+---+---+---+----+
namespace wayfuse::simulator {
namespace {

constexpr double kShopDepth_m = 14.0;
constexpr double kConcourse_m = 6.0;
constexpr double kPlaza_m = 10.0;        // at both ends
constexpr double kAtriumHalf_m = 22.0;   // along the length
constexpr double kBridge_m = 4.0;
constexpr double kLeastShop_m = 6.0, kMostShop_m = 18.0;
constexpr double kDoor_m = 3.5;
constexpr double kThreshold_m = 2.0;     // behind the door before a visitor turns
constexpr double kEscalator_m = 12.0;    // on the plan
constexpr double kOperatorSpacing_m = 12.0;
constexpr double kGlass_db = 2.0, kShopWall_db = 6.0, kOuterWall_db = 12.0;

struct Site {
  BuildingPoint point;
  bool shop;
};

class MallFloor {
 public:
  MallFloor(World& world, FloorOrdinal ordinal, double length_m, double width_m, Random& random)
      : sketch_(world, ordinal, length_m, width_m, kOuterWall_db), ground_(ordinal.value == 0), length_m_(length_m),
        width_m_(width_m), random_(random) {}

  WorldFloor build() {
    const double south = kShopDepth_m, north = width_m_ - kShopDepth_m;
    const double inner0 = south + kConcourse_m, inner1 = north - kConcourse_m, middle = width_m_ / 2;
    for (const Box box : {Box{0, south, length_m_, inner0}, Box{0, inner1, length_m_, north}, Box{0, south, kPlaza_m, north},
                          Box{length_m_ - kPlaza_m, south, length_m_, north}}) {
      sketch_.walkable(box);
    }
    shop_row(0, 0, length_m_, south, true, south_);
    shop_row(0, north, length_m_, width_m_, false, north_);
    for (const auto& [x0, x1] : {std::pair{kPlaza_m, length_m_ / 2 - kAtriumHalf_m},
                                 std::pair{length_m_ / 2 + kAtriumHalf_m, length_m_ - kPlaza_m}}) {
      if (x1 - x0 < kLeastShop_m) continue;
      shop_row(x0, inner0, x1, middle, false, south_);
      shop_row(x0, middle, x1, inner1, true, north_);
      sketch_.wall({x0, middle}, {x1, middle}, kShopWall_db);
      sketch_.wall({x0, inner0}, {x0, inner1}, kShopWall_db);
      sketch_.wall({x1, inner0}, {x1, inner1}, kShopWall_db);
    }
    atrium(inner0, inner1);
    passages();
    for (double x = kOperatorSpacing_m / 2; x < length_m_; x += kOperatorSpacing_m) {
      sites_.push_back({{x, south_line()}, false});
      sites_.push_back({{x, north_line()}, false});
    }
    return sketch_.take();
  }

  std::size_t lift() const { return lift_; }
  std::size_t stairs() const { return stairs_; }
  std::size_t escalator_up() const { return up_; }
  std::size_t escalator_down() const { return down_; }
  const std::vector<Site>& sites() const { return sites_; }

 private:
  double south_line() const { return kShopDepth_m + kConcourse_m / 2; }
  double north_line() const { return width_m_ - south_line(); }

  // Shops of many widths between y0 and y1, doors on the upper or the lower side.
  void shop_row(double x0, double y0, double x1, double y1, bool doors_above, std::vector<FloorSketch::Stop>& concourse) {
    for (double a = x0; a < x1;) {
      double b = a + kLeastShop_m + (kMostShop_m - kLeastShop_m) * random_.uniform();
      if (x1 - b < kLeastShop_m) b = x1;
      shop({a, y0, b, y1}, doors_above, concourse);
      if (b < x1) sketch_.wall({b, y0}, {b, y1}, kShopWall_db);
      a = b;
    }
  }

  void shop(Box box, bool door_above, std::vector<FloorSketch::Stop>& concourse) {
    const double door = 0.5 * (box.x0 + box.x1), front = door_above ? box.y1 : box.y0, inwards = door_above ? -1.0 : 1.0;
    sketch_.walkable({box.x0 + 0.1, box.y0 + 0.1, box.x1 - 0.1, box.y1 - 0.1});
    sketch_.walkable({door - kDoor_m / 2, front - 0.4, door + kDoor_m / 2, front + 0.4});
    sketch_.wall_with_door(box.x0, box.x1, front, door, kDoor_m, kGlass_db);
    const auto inside = [&] {
      const double depth_m = std::abs(box.y1 - box.y0);
      return BuildingPoint{box.x0 + 1 + (box.x1 - box.x0 - 2) * random_.uniform(),
                           front + inwards * (kThreshold_m + 1 + (depth_m - kThreshold_m - 2) * random_.uniform())};
    };
    const std::size_t outside = sketch_.node({door, door_above ? front + kConcourse_m / 2 : front - kConcourse_m / 2});
    const std::size_t threshold = sketch_.node({door, front + inwards * kThreshold_m});
    const std::size_t shelf = sketch_.node(inside(), true);
    sketch_.join(outside, threshold);
    sketch_.join(threshold, shelf);
    concourse.push_back({door, outside});
    sites_.push_back({inside(), true});
  }

  // Open ground below, a bridge above.
  void atrium(double y0, double y1) {
    const double x = length_m_ / 2, half_m = ground_ ? kAtriumHalf_m : kBridge_m / 2;
    sketch_.walkable({x - half_m, y0, x + half_m, y1});
    const std::size_t middle = sketch_.node({x, width_m_ / 2}, ground_);
    const std::size_t south = sketch_.node({x, south_line()}), north = sketch_.node({x, north_line()});
    sketch_.join(south, middle);
    sketch_.join(middle, north);
    south_.push_back({x, south});
    north_.push_back({x, north});
  }

  void passages() {
    const double west = kPlaza_m / 2, east = length_m_ - kPlaza_m / 2, x = length_m_ / 2, middle = width_m_ / 2;
    up_ = escalator(x - kEscalator_m / 2);
    down_ = escalator(x + kEscalator_m / 2);
    const std::size_t sw = sketch_.node({west, south_line()}), nw = sketch_.node({west, north_line()});
    const std::size_t se = sketch_.node({east, south_line()}), ne = sketch_.node({east, north_line()});
    const std::size_t before_lift = sketch_.node({west, middle}), before_stairs = sketch_.node({east, middle});
    lift_ = sketch_.node({west - 2.5, middle}, false, Passage::kLift);
    stairs_ = sketch_.node({east + 2.5, middle}, false, Passage::kStairs);
    south_.push_back({west, sw});
    south_.push_back({east, se});
    north_.push_back({west, nw});
    north_.push_back({east, ne});
    sketch_.chain(south_);
    sketch_.chain(north_);
    for (const auto& [a, b] : {std::pair{sw, before_lift}, std::pair{before_lift, nw}, std::pair{before_lift, lift_},
                              std::pair{se, before_stairs}, std::pair{before_stairs, ne}, std::pair{before_stairs, stairs_}}) {
      sketch_.join(a, b);
    }
  }

  std::size_t escalator(double x) {
    const std::size_t landing = sketch_.node({x, north_line() - 1.8}, false, Passage::kEscalator);
    const std::size_t outside = sketch_.node({x, north_line()});
    sketch_.join(landing, outside);
    north_.push_back({x, outside});
    return landing;
  }

  FloorSketch sketch_;
  bool ground_;
  double length_m_;
  double width_m_;
  Random& random_;
  std::vector<FloorSketch::Stop> south_, north_;
  std::vector<Site> sites_;
  std::size_t lift_ = 0, stairs_ = 0, up_ = 0, down_ = 0;
};

// The operator's access points speak for many networks, a shop's for half as many.
void place_transmitters(World& world, FloorOrdinal floor, const std::vector<Site>& sites, const WorldSettings& settings,
                        Random& random) {
  const int networks = count_within(settings.networks_per_transmitter, 6, 1, 8, "networks");
  const int wanted = count_within(settings.transmitters_per_floor, std::min(200, static_cast<int>(sites.size())), 1, 200, "transmitters");
  for (int i = 0; i < wanted; ++i) {
    const Site& site = sites[static_cast<std::size_t>(i) % sites.size()];
    const BuildingPoint point{site.point.x_m + 0.5 * random.normal(), site.point.y_m + 0.5 * random.normal()};
    Transmitter transmitter = transmitter_at(point, floor, site.shop ? (networks + 1) / 2 : networks, random);
    transmitter.height_m = site.shop ? 2.5 : 4.0;
    world.transmitters.push_back(std::move(transmitter));
  }
}

// Steel in the ground and in what moves people.
void place_anomalies(World& world, FloorOrdinal floor, int random_ones, double length_m, double width_m, Random& random) {
  for (int i = 0; i < random_ones; ++i) {
    const double x_m = random.uniform() * length_m;
    world.anomalies.push_back(anomaly_at({x_m, random.uniform() * width_m}, floor, random));
  }
  for (const WayNode& way : world.ways) {
    if (way.place.floor != floor || (way.passage != Passage::kLift && way.passage != Passage::kEscalator)) continue;
    MagneticAnomaly steel = anomaly_at(way.place.point, floor, random);
    steel.strength_ut += 15.0;
    steel.reach_m += 1.0;
    world.anomalies.push_back(steel);
  }
}

}  // namespace

World make_mall(const WorldSettings& settings, Random& random) {
  const int floors = count_within(settings.floors, 4, 1, 20, "floors");
  const double length_m = within(settings.length_m, 120, 60, 200, "length");
  const double width_m = within(settings.width_m, 64, 50, 120, "width");
  const int anomalies = count_within(settings.anomalies_per_floor, 12, 0, 100, "anomalies");
  World world;
  world.name = "Demo mall";
  world.storey_m = 5.0;
  world.seed = random.bits();
  const double inner_m = kShopDepth_m + kConcourse_m;
  world.openings.push_back(polygon_of({length_m / 2 - kAtriumHalf_m, inner_m, length_m / 2 + kAtriumHalf_m, width_m - inner_m}));
  Shaft lift, stairs;
  std::optional<std::size_t> up_from_below;
  for (int f = 0; f < floors; ++f) {
    MallFloor floor(world, {f}, length_m, width_m, random);
    world.floors.push_back(floor.build());
    lift.nodes.push_back(floor.lift());
    stairs.nodes.push_back(floor.stairs());
    if (up_from_below) join_floors(world, {{*up_from_below, floor.escalator_down()}});
    up_from_below = floor.escalator_up();
    place_transmitters(world, {f}, floor.sites(), settings, random);
    place_anomalies(world, {f}, anomalies, length_m, width_m, random);
  }
  join_floors(world, lift);
  join_floors(world, stairs);
  return world;
}

}  // namespace wayfuse::simulator
