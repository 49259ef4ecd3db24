#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/proto/scan.hpp"

namespace wayfuse::simulator {

/// A wall in the plane of a floor, as radio sees it.
struct Wall {
  BuildingPoint from;
  BuildingPoint to;
  double loss_db = 4.0;   ///< for one crossing
};

/// A Wi-Fi access point; several networks (BSSIDs) may live on one radio.
struct Transmitter {
  std::vector<Bssid> bssids;
  BuildingPoint point;
  double height_m = 2.5;          ///< above its floor
  FloorOrdinal floor;
  double power_dbm = -38.0;       ///< at 1 m
  std::uint16_t frequency_mhz = 2437;
};

/// A source of magnetic disturbance: a vertical dipole below or above the floor, like a pillar's reinforcement.
struct MagneticAnomaly {
  Place place;
  double strength_ut = 20.0;      ///< at its centre
  double reach_m = 1.5;           ///< falls off as a Gaussian of this width
  Heading direction;              ///< of its horizontal part, building frame
};

/// How a person gets from one floor to the next.
enum class Passage : std::uint8_t {
  kNone,
  kStairs,      ///< on foot, slower than on the level
  kEscalator,   ///< carried along, standing: motion without steps
  kLift,        ///< waits, rides straight up or down, any number of storeys at once
};

/// A place people pass or go to: a node of the walking graph.
struct WayNode {
  Place place;
  std::vector<std::size_t> neighbours;
  bool room = false;              ///< somewhere people go to and pause
  Passage passage = Passage::kNone;   ///< an edge between floors joins two nodes of one kind
};

struct WorldFloor {
  Floor plan;
  std::vector<Wall> walls;
};

/// A building with everything a stand-in phone can sense in it.
struct World {
  std::string name;
  std::string pipeline = "default";   ///< preset the building asks for
  Georeference georeference;
  MagneticField magnetic_field;
  double storey_m = 3.6;
  std::vector<WorldFloor> floors;
  std::vector<Polygon> openings;      ///< holes in every ceiling: radio passes between storeys there
  std::vector<Transmitter> transmitters;
  std::vector<MagneticAnomaly> anomalies;
  std::vector<WayNode> ways;
  std::uint64_t seed = 1;         ///< of its shadowing field
};

/// Kinds of buildings; each is a radio and motion problem of its own.
enum class WorldKind : std::uint8_t {
  kOffice,      ///< corridors, thin walls, an access point every few rooms
  kMall,        ///< open concourses round an atrium, hundreds of radios, escalators and lifts
  kWarehouse,   ///< one hall of steel shelves: few radios, few walls, a bent magnetic field
};
/// `office`, `mall`, `warehouse`.
const std::vector<std::string>& world_kind_names();
std::optional<WorldKind> world_kind_of(std::string_view name);

/// Absent = what is usual for the kind.
struct WorldSettings {
  WorldKind kind = WorldKind::kOffice;
  std::optional<int> floors;                   ///< 1..20; office 2, mall 4, warehouse 1
  std::optional<double> length_m;              ///< 40..200; office 60, mall 120, warehouse 90
  std::optional<double> width_m;               ///< office 28..60, usually 32; mall 50..120, 64; warehouse 30..120, 50
  std::optional<int> transmitters_per_floor;   ///< 1..200; office 9, mall one a shop and one every 12 m of concourse, warehouse 8
  std::optional<int> networks_per_transmitter; ///< 1..8; office 2, mall 4, warehouse 2
  std::optional<int> anomalies_per_floor;      ///< 0..100; office 6, mall 12, warehouse one a shelf
};

/// Draws a building; the same settings and generator give the same one. Throws std::invalid_argument naming the setting
/// that is out of its range.
World make_world(const WorldSettings& settings, Random& random);

/// The way with the least effort between two nodes, in metres walked (a lift costs the wait for it); empty if there is none.
std::vector<std::size_t> shortest_way(const World& world, std::size_t from, std::size_t to);

/// The building as the admin API takes it: name, georeference, magnetic field, floors with outline and walkable area.
std::string to_building_json(const World& world);

}  // namespace wayfuse::simulator
