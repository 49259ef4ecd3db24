#include "sdk/src/simulator/floor_sketch.hpp"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <stdexcept>

namespace wayfuse::simulator {

Polygon polygon_of(Box box) { return {{{{box.x0, box.y0}, {box.x1, box.y0}, {box.x1, box.y1}, {box.x0, box.y1}}}}; }

FloorSketch::FloorSketch(World& world, FloorOrdinal ordinal, double length_m, double width_m, double outer_wall_db)
    : world_(world), ordinal_(ordinal) {
  floor_.plan.ordinal = ordinal;
  floor_.plan.label = ordinal.value == 0 ? "Ground" : "Level " + std::to_string(ordinal.value);
  floor_.plan.outline = polygon_of({0, 0, length_m, width_m});
  const BuildingPoint corners[] = {{0, 0}, {length_m, 0}, {length_m, width_m}, {0, width_m}};
  for (int i = 0; i < 4; ++i) wall(corners[i], corners[(i + 1) % 4], outer_wall_db);
}

void FloorSketch::wall_with_door(double x0, double x1, double y, double door, double door_m, double loss_db) {
  wall({x0, y}, {door - door_m / 2, y}, loss_db);
  wall({door + door_m / 2, y}, {x1, y}, loss_db);
}

std::size_t FloorSketch::node(BuildingPoint point, bool room, Passage passage) {
  world_.ways.push_back({{point, ordinal_}, {}, room, passage});
  return world_.ways.size() - 1;
}

void FloorSketch::join(std::size_t a, std::size_t b) {
  world_.ways[a].neighbours.push_back(b);
  world_.ways[b].neighbours.push_back(a);
}

void FloorSketch::chain(std::vector<Stop>& stops) {
  std::ranges::sort(stops, {}, &Stop::along_m);
  for (std::size_t i = 1; i < stops.size(); ++i) join(stops[i - 1].node, stops[i].node);
}

void join_floors(World& world, const Shaft& shaft) {
  for (std::size_t i = 1; i < shaft.nodes.size(); ++i) {
    world.ways[shaft.nodes[i - 1]].neighbours.push_back(shaft.nodes[i]);
    world.ways[shaft.nodes[i]].neighbours.push_back(shaft.nodes[i - 1]);
  }
}

double within(std::optional<double> asked, double usual, double least, double most, const char* name) {
  const double value = asked.value_or(usual);
  if (value >= least && value <= most) return value;
  throw std::invalid_argument(std::string(name) + ": outside " + std::to_string(static_cast<int>(least)) + ".." +
                              std::to_string(static_cast<int>(most)) + " for this kind of building");
}

int count_within(std::optional<int> asked, int usual, int least, int most, const char* name) {
  return static_cast<int>(within(asked ? std::optional<double>(*asked) : std::nullopt, usual, least, most, name));
}

Transmitter transmitter_at(BuildingPoint point, FloorOrdinal floor, int networks, Random& random) {
  constexpr std::uint16_t kChannels_mhz[] = {2412, 2437, 2462, 5180, 5220, 5260, 5300, 5500};
  Transmitter transmitter;
  transmitter.point = point;
  transmitter.floor = floor;
  transmitter.power_dbm = -38.0 + 2.0 * random.normal();
  transmitter.frequency_mhz = kChannels_mhz[random.below(std::size(kChannels_mhz))];
  const std::uint64_t radio = 0x00'1b'2c'00'00'00u + (random.bits() & 0xff'ff'f0u);
  for (int n = 0; n < networks; ++n) transmitter.bssids.push_back({radio + static_cast<unsigned>(n)});
  return transmitter;
}

MagneticAnomaly anomaly_at(BuildingPoint point, FloorOrdinal floor, Random& random) {
  const double strength_ut = 8.0 + 14.0 * random.uniform();
  const double reach_m = 1.0 + random.uniform();
  return {{point, floor}, strength_ut, reach_m, Heading::from_radians(2 * std::numbers::pi * random.uniform())};
}

}  // namespace wayfuse::simulator
