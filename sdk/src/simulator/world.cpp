#include "sdk/src/simulator/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

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
constexpr double kStairs_m = 8.0;  // walked per storey

struct Box {
  double x0, y0, x1, y1;
};

Polygon polygon_of(Box box) {
  return {{{{box.x0, box.y0}, {box.x1, box.y0}, {box.x1, box.y1}, {box.x0, box.y1}}}};
}

/// Draws one floor: collects plan, walls and ways while rooms are added along corridors.
class FloorBuilder {
 public:
  FloorBuilder(World& world, FloorOrdinal ordinal, const OfficeSettings& settings)
      : world_(world), ordinal_(ordinal), length_m_(settings.length_m), width_m_(settings.width_m) {}

  WorldFloor build() {
    outer_walls();
    corridors();
    const double inner0 = kRoomDepth_m + kCorridor_m;
    const double inner1 = width_m_ - kRoomDepth_m - kCorridor_m;
    const double middle = 0.5 * (inner0 + inner1);
    room_row(0, 0, length_m_, kRoomDepth_m, true, south_);
    room_row(0, width_m_ - kRoomDepth_m, length_m_, width_m_, false, north_);
    room_row(kCorridor_m, inner0, length_m_ - kCorridor_m, middle, false, south_);
    room_row(kCorridor_m, middle, length_m_ - kCorridor_m, inner1, true, north_);
    wall({kCorridor_m, middle}, {length_m_ - kCorridor_m, middle}, kCoreWall_db);
    connect_corridors();
    return std::move(floor_);
  }

  std::size_t stairs_node() const { return stairs_; }

 private:
  struct CorridorNode {
    double x_m;
    std::size_t node;
  };

  void wall(BuildingPoint from, BuildingPoint to, double loss_db) { floor_.walls.push_back({from, to, loss_db}); }

  std::size_t node(BuildingPoint point, bool room) {
    world_.ways.push_back({{point, ordinal_}, {}, room});
    return world_.ways.size() - 1;
  }

  void join(std::size_t a, std::size_t b) {
    world_.ways[a].neighbours.push_back(b);
    world_.ways[b].neighbours.push_back(a);
  }

  void outer_walls() {
    floor_.plan.ordinal = ordinal_;
    floor_.plan.label = ordinal_.value == 0 ? "Ground" : "Level " + std::to_string(ordinal_.value);
    floor_.plan.outline = polygon_of({0, 0, length_m_, width_m_});
    const BuildingPoint corners[] = {{0, 0}, {length_m_, 0}, {length_m_, width_m_}, {0, width_m_}};
    for (int i = 0; i < 4; ++i) wall(corners[i], corners[(i + 1) % 4], kOuterWall_db);
  }

  void corridors() {
    const double s0 = kRoomDepth_m, s1 = kRoomDepth_m + kCorridor_m;
    const double n0 = width_m_ - kRoomDepth_m - kCorridor_m, n1 = width_m_ - kRoomDepth_m;
    for (const Box box : {Box{0, s0, length_m_, s1}, Box{0, n0, length_m_, n1}, Box{0, s0, kCorridor_m, n1},
                          Box{length_m_ - kCorridor_m, s0, length_m_, n1}}) {
      floor_.plan.walkable.push_back(polygon_of(box));
    }
    wall({kCorridor_m, s1}, {kCorridor_m, n0}, kCoreWall_db);
    wall({length_m_ - kCorridor_m, s1}, {length_m_ - kCorridor_m, n0}, kCoreWall_db);
  }

  // A row of rooms between y0 and y1, their doors on the upper or the lower side.
  void room_row(double x0, double y0, double x1, double y1, bool doors_above, std::vector<CorridorNode>& corridor) {
    const int rooms = std::max(1, static_cast<int>(std::round((x1 - x0) / kRoomWidth_m)));
    const double width_m = (x1 - x0) / rooms;
    const double door_y = doors_above ? y1 : y0;
    const double corridor_y = door_y + (doors_above ? 0.5 : -0.5) * kCorridor_m;
    for (int i = 0; i < rooms; ++i) {
      const double a = x0 + i * width_m, b = a + width_m, door = 0.5 * (a + b);
      const double t = 0.5 * kWallThickness_m;
      floor_.plan.walkable.push_back(polygon_of({a + t, y0 + t, b - t, y1 - t}));
      floor_.plan.walkable.push_back(polygon_of({door - kDoor_m / 2, door_y - 0.3, door + kDoor_m / 2, door_y + 0.3}));
      if (i > 0) wall({a, y0}, {a, y1}, kInnerWall_db);
      wall({a, door_y}, {door - kDoor_m / 2, door_y}, kInnerWall_db);
      wall({door + kDoor_m / 2, door_y}, {b, door_y}, kInnerWall_db);
      const std::size_t centre = node({door, 0.5 * (y0 + y1)}, true);
      const std::size_t outside = node({door, corridor_y}, false);
      join(centre, outside);
      corridor.push_back({door, outside});
    }
  }

  void connect_corridors() {
    const double y_south = kRoomDepth_m + kCorridor_m / 2, y_north = width_m_ - y_south;
    const double x_west = kCorridor_m / 2, x_east = length_m_ - x_west;
    const std::size_t sw = node({x_west, y_south}, false), se = node({x_east, y_south}, false);
    const std::size_t nw = node({x_west, y_north}, false), ne = node({x_east, y_north}, false);
    stairs_ = node({x_west, width_m_ / 2}, false);
    chain(south_, sw, se, x_west, x_east);
    chain(north_, nw, ne, x_west, x_east);
    join(sw, stairs_);
    join(stairs_, nw);
    join(se, ne);
  }

  void chain(std::vector<CorridorNode>& corridor, std::size_t west, std::size_t east, double x_west, double x_east) {
    corridor.push_back({x_west, west});
    corridor.push_back({x_east, east});
    std::ranges::sort(corridor, {}, &CorridorNode::x_m);
    for (std::size_t i = 1; i < corridor.size(); ++i) join(corridor[i - 1].node, corridor[i].node);
  }

  World& world_;
  FloorOrdinal ordinal_;
  double length_m_;
  double width_m_;
  WorldFloor floor_;
  std::vector<CorridorNode> south_;
  std::vector<CorridorNode> north_;
  std::size_t stairs_ = 0;
};

// Access points stand in a jittered lattice along both corridors, as installers put them.
void place_transmitters(World& world, const OfficeSettings& settings, Random& random) {
  constexpr std::uint16_t kChannels_mhz[] = {2412, 2437, 2462, 5180, 5220, 5260, 5300, 5500};
  for (int f = 0; f < settings.floors; ++f) {
    for (int i = 0; i < settings.transmitters_per_floor; ++i) {
      Transmitter transmitter;
      const double share = (i + 0.5) / settings.transmitters_per_floor;
      transmitter.point.x_m = std::clamp(share * settings.length_m + 2.0 * random.normal(), 1.0, settings.length_m - 1.0);
      const double lane = (i + f) % 3 == 0 ? 0.5 : (i + f) % 3 == 1 ? 0.26 : 0.74;
      transmitter.point.y_m = std::clamp(lane * settings.width_m + 1.5 * random.normal(), 1.0, settings.width_m - 1.0);
      transmitter.floor = {f};
      transmitter.power_dbm = -38.0 + 2.0 * random.normal();
      transmitter.frequency_mhz = kChannels_mhz[random.below(std::size(kChannels_mhz))];
      const std::uint64_t radio = 0x00'1b'2c'00'00'00u + (random.bits() & 0xff'ff'f0u);
      for (int n = 0; n < settings.networks_per_transmitter; ++n) transmitter.bssids.push_back({radio + static_cast<unsigned>(n)});
      world.transmitters.push_back(std::move(transmitter));
    }
  }
}

void place_anomalies(World& world, const OfficeSettings& settings, Random& random) {
  for (int f = 0; f < settings.floors; ++f) {
    for (int i = 0; i < settings.anomalies_per_floor; ++i) {
      world.anomalies.push_back({{{random.uniform() * settings.length_m, random.uniform() * settings.width_m}, {f}},
                                 8.0 + 14.0 * random.uniform(), 1.0 + random.uniform(),
                                 Heading::from_radians(2 * std::numbers::pi * random.uniform())});
    }
  }
}

double way_length_m(const WayNode& a, const WayNode& b) {
  const double flat_m = distance_m(a.place.point, b.place.point);
  return a.place.floor == b.place.floor ? flat_m : flat_m + kStairs_m;
}

}  // namespace

World make_office(const OfficeSettings& settings, Random& random) {
  World world;
  world.name = "Demo office";
  world.georeference = {{47.3769, 8.5417}, 0.2};
  world.magnetic_field = {0.05, 1.10, 48.0};
  world.seed = random.bits();
  std::vector<std::size_t> stairs;
  for (int f = 0; f < settings.floors; ++f) {
    FloorBuilder builder(world, {f}, settings);
    world.floors.push_back(builder.build());
    stairs.push_back(builder.stairs_node());
  }
  for (std::size_t i = 1; i < stairs.size(); ++i) {
    world.ways[stairs[i - 1]].neighbours.push_back(stairs[i]);
    world.ways[stairs[i]].neighbours.push_back(stairs[i - 1]);
  }
  place_transmitters(world, settings, random);
  place_anomalies(world, settings, random);
  return world;
}

std::vector<std::size_t> shortest_way(const World& world, std::size_t from, std::size_t to) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::vector<double> far(world.ways.size(), kFar);
  std::vector<std::size_t> before(world.ways.size(), from);
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  far[from] = 0;
  open.push({0, from});
  while (!open.empty()) {
    const auto [length_m, node] = open.top();
    open.pop();
    if (length_m > far[node]) continue;
    for (const std::size_t next : world.ways[node].neighbours) {
      const double through_m = length_m + way_length_m(world.ways[node], world.ways[next]);
      if (through_m < far[next]) {
        far[next] = through_m;
        before[next] = node;
        open.push({through_m, next});
      }
    }
  }
  if (far[to] == kFar) return {};
  std::vector<std::size_t> way = {to};
  while (way.back() != from) way.push_back(before[way.back()]);
  std::ranges::reverse(way);
  return way;
}

}  // namespace wayfuse::simulator
