#pragma once

#include "sdk/src/simulator/world.hpp"

namespace wayfuse::simulator {

struct Box {
  double x0, y0, x1, y1;
};
Polygon polygon_of(Box box);

/// One floor while it is drawn: plan and walls of its own, ways in the world's graph.
class FloorSketch {
 public:
  /// A node of the graph at its place along a corridor.
  struct Stop {
    double along_m;
    std::size_t node;
  };

  /// Outline and outer walls of a rectangle with its corner at the origin.
  FloorSketch(World& world, FloorOrdinal ordinal, double length_m, double width_m, double outer_wall_db);

  void walkable(Box box) { floor_.plan.walkable.push_back(polygon_of(box)); }
  void wall(BuildingPoint from, BuildingPoint to, double loss_db) { floor_.walls.push_back({from, to, loss_db}); }
  /// A wall along y = `y` with a gap around x = `door`.
  void wall_with_door(double x0, double x1, double y, double door, double door_m, double loss_db);

  std::size_t node(BuildingPoint point, bool room = false, Passage passage = Passage::kNone);
  void join(std::size_t a, std::size_t b);
  /// Joins neighbours along a corridor; sorts the stops.
  void chain(std::vector<Stop>& stops);

  WorldFloor take() { return std::move(floor_); }

 private:
  World& world_;
  FloorOrdinal ordinal_;
  WorldFloor floor_;
};

/// Where one building's ways between floors are: one node a floor each.
struct Shaft {
  std::vector<std::size_t> nodes;   ///< ascending floors
};
void join_floors(World& world, const Shaft& shaft);

/// What the settings say, or what is usual; throws std::invalid_argument naming the setting.
double within(std::optional<double> asked, double usual, double least, double most, const char* name);
int count_within(std::optional<int> asked, int usual, int least, int most, const char* name);

/// One access point with `networks` addresses on one radio.
Transmitter transmitter_at(BuildingPoint point, FloorOrdinal floor, int networks, Random& random);

/// A magnetic disturbance, 8..22 microtesla.
MagneticAnomaly anomaly_at(BuildingPoint point, FloorOrdinal floor, Random& random);

World make_office(const WorldSettings& settings, Random& random);
World make_mall(const WorldSettings& settings, Random& random);
World make_warehouse(const WorldSettings& settings, Random& random);

}  // namespace wayfuse::simulator
