#pragma once

#include <string>
#include <vector>

#include "sdk/src/simulator/device.hpp"
#include "sdk/src/simulator/hand_moves.hpp"
#include "sdk/src/simulator/walker.hpp"
#include "sdk/src/simulator/world.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/sdk/heading_estimator.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse::simulator {

/// How the phone is carried.
enum class Carrying : std::uint8_t { kTexting, kPhoning, kPocket, kSwinging };
inline constexpr int kCarryingModes = 4;
/// `texting`, `phoning`, `pocket`, `swinging`.
const std::vector<std::string>& carrying_names();

struct CarryingSettings {
  Carrying mode = Carrying::kTexting;   ///< at the start
  Duration stay{0};                     ///< mean time in one mode before another; 0 = never another
  double wander_rad = 0.13;             ///< 1 sigma: nobody holds a phone straight ahead all the time
  double fidgets_per_min = 0.0;         ///< crouches, raises the phone, shifts, knocks it: so many times a minute
};

/// Turns the truth of a walk into what a phone's motion sensors say.
///
/// Attitude is a smooth function of time (carrying mode, sway of the gait); the gyroscope is its derivative, the
/// accelerometer gravity plus the gait's bounce, the magnetometer the local field with the building's anomalies.
class MotionSensors {
 public:
  MotionSensors(const World& world, const Walker& walker, Device device, CarryingSettings carrying, Random random);

  /// The sensors at `since_start`, stamped `time`.
  MargSample sample(Duration since_start, PhoneTime time);
  /// Where the phone really points, body -> true east/north/up.
  Quaternion attitude(Duration since_start) const;
  Carrying carrying(Duration since_start) const;

 private:
  struct Pose {
    double yaw_rad, pitch_rad, roll_rad;   // of the phone against the walker
    double sway_rad;                       // yaw swing with every second step
    double swing_rad;                      // pitch swing of an arm or leg
    double height_m;                       // above the floor
  };
  struct Change {
    Duration at;
    Carrying to;
  };
  struct Wave {
    double radps, phase_rad;
  };
  MotionSensors(const World& world, const Walker& walker, Device device, CarryingSettings carrying, Random random, Random of_the_hand);
  static Pose pose_of(Carrying carrying);
  double wander(const std::vector<Wave>& waves, Duration since_start) const;
  Pose pose_at(Duration since_start) const;
  Vector3 specific_force_enu(const Truth& truth, double hand_mps2) const;
  Vector3 field_enu(const Place& place) const;
  Vector3 noisy(const Vector3& value, double sigma);

  const World& world_;
  const Walker& walker_;
  Device device_;
  std::vector<Change> changes_;   // ascending; the first at the start
  double wander_rad_;
  std::vector<Wave> yaw_waves_, pitch_waves_;
  Random random_;
  double bounce_;   // this walker's
  HandMoves hand_;
};

}  // namespace wayfuse::simulator
