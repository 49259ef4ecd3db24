#pragma once

#include <cstdint>
#include <string>
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

/// A way a person can go: an edge of the walking graph.
struct WayNode {
  Place place;
  std::vector<std::size_t> neighbours;
  bool room = false;              ///< somewhere people go to and pause
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
  std::vector<Transmitter> transmitters;
  std::vector<MagneticAnomaly> anomalies;
  std::vector<WayNode> ways;
  std::uint64_t seed = 1;         ///< of its shadowing field
};

struct OfficeSettings {
  int floors = 2;                    ///< 1..20
  double length_m = 60.0;            ///< 40..200
  double width_m = 32.0;             ///< 28..60
  int transmitters_per_floor = 9;    ///< 1..200
  int networks_per_transmitter = 2;  ///< 1..8
  int anomalies_per_floor = 6;       ///< 0..100
};

/// An office: a ring corridor, rooms on both sides of it, stairs at one end of each floor.
///
///     +--+--+--+--+--+--+--+--+    rooms
///     |==+==+==+==+==+==+==+==|    corridor
///     | |rooms  |core |rooms| |
///     |S|-------+-----+-----| |    S: stairs
///     |==+==+==+==+==+==+==+==|
///     +--+--+--+--+--+--+--+--+
World make_office(const OfficeSettings& settings, Random& random);

/// The way with the least metres between two nodes (stairs count their length); empty if there is none.
std::vector<std::size_t> shortest_way(const World& world, std::size_t from, std::size_t to);

/// The building as the admin API takes it: name, georeference, magnetic field, floors with outline and walkable area.
std::string to_building_json(const World& world);

}  // namespace wayfuse::simulator
