#pragma once

#include <vector>

#include "sdk/src/simulator/world.hpp"

namespace wayfuse::simulator {

struct PropagationSettings {
  double decay_db_per_decade = 21.0;   ///< in the open, before walls
  double floor_loss_db = 17.0;         ///< a ceiling
  double opening_loss_db = 4.0;        ///< a storey, where the way leads through an opening of the ceilings
  double most_walls_db = 35.0;         ///< energy finds other ways round
  double shadowing_db = 4.0;           ///< 1 sigma of the static pattern
  double shadowing_reach_m = 4.0;      ///< its correlation length
  double body_db = 5.0;                ///< extra loss straight behind the walker
};

/// How strong a transmitter is at a place: wall by wall, with a fixed pattern of shadows.
///
/// Multi-wall (COST 231) mean plus a stationary Gaussian field made of random waves, one pattern a transmitter and floor:
/// it depends on the place alone, so that a survey and a later walk meet the same shadows. The simulator's own: nothing
/// that locates ever sees this code.
class Propagation {
 public:
  Propagation(const World& world, PropagationSettings settings);

  /// Mean level without fading, dBm. `facing` of the person who holds the phone.
  double level_dbm(std::size_t transmitter, const Place& at, Heading facing) const;

 private:
  struct Wave {
    double kx, ky, phase;
  };
  double walls_db(const WorldFloor& floor, BuildingPoint from, BuildingPoint to) const;
  double storey_db(BuildingPoint from, BuildingPoint to) const;
  double shadow_db(std::size_t transmitter, const Place& at) const;

  const World& world_;
  PropagationSettings settings_;
  std::vector<Wave> waves_;   // kWaves for each transmitter and floor
};

}  // namespace wayfuse::simulator
