#pragma once

#include <span>
#include <vector>

#include "sdk/src/simulator/world.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse::simulator {

/// Where the walker really is.
struct Truth {
  Place place;
  double height_m = 0.0;        ///< above the ground floor
  Heading heading;              ///< walking direction, building frame; kept while standing
  double speed_mps = 0.0;       ///< on foot; 0 while standing, also on an escalator
  double lift_mps2 = 0.0;       ///< acceleration upwards of the lift that carries the walker
  double swing = 0.0;           ///< 0..1, how far arms and legs swing: follows the speed within half a second
  double gait_phase = 0.0;      ///< steps since the start, whole numbers at heel strikes
};

struct GaitSettings {
  double speed_mps = 1.25;       ///< preferred, 0.3..2.5
  double step_length_m = 0.70;   ///< at that speed, 0.3..1.1
  double pause_s = 4.0;          ///< mean stay in a room it visits
  double pause_share = 0.6;      ///< of rooms it stays in
};

/// A person walking from room to room, taking stairs, escalators and lifts, known at every instant.
///
/// The whole walk is drawn when it is made: the same generator gives the same walk.
class Walker {
 public:
  /// Starts at a random room and visits random others until `length` has passed. `floors` empty = all floors.
  Walker(const World& world, const GaitSettings& gait, Duration length, const std::vector<FloorOrdinal>& floors, Random& random);
  /// Walks the given nodes once, without pauses; for surveys.
  Walker(const World& world, const GaitSettings& gait, const std::vector<std::size_t>& nodes, Random& random);

  Truth at(Duration since_start) const;
  Duration length() const;

 private:
  struct Leg;
  static std::vector<Leg> legs_through(const World& world, const std::vector<std::size_t>& nodes);
  void stand(const Truth& at, Duration for_time);
  void walk(const World& world, const std::vector<std::size_t>& nodes, const GaitSettings& gait, Random& random);
  void on_foot(std::span<const Leg> legs, const GaitSettings& gait, Random& random);
  void ride_escalator(const Leg& leg);
  void ride_lift(const World& world, const Leg& leg, Random& random);
  void swing_arms();

  std::vector<Truth> timeline_;   // every kTick
};

}  // namespace wayfuse::simulator
