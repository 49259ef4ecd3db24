#pragma once

#include <string>

#include "sdk/src/simulator/walker.hpp"
#include "sdk/src/simulator/world.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/sdk/heading_estimator.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse::simulator {

/// How the phone is carried.
enum class Carrying : std::uint8_t { kTexting, kPhoning, kPocket, kSwinging };

/// One phone model's and specimen's faults.
struct Device {
  std::string model = "stand-in";
  double rss_offset_db = 0.0;          ///< against the surveyor's phone
  double rss_noise_db = 2.0;           ///< 1 sigma a reading, before rounding to whole dBm
  double sensitivity_dbm = -92.0;      ///< half of the frames at this level are heard
  double acceleration_noise_mps2 = 0.03;
  double gyro_noise_radps = 0.003;
  Vector3 gyro_bias_radps;
  double field_noise_ut = 0.4;
  Vector3 hard_iron_ut;
  double rate_hz = 50.0;               ///< of the motion sensors, 25..400
};
/// A specimen with faults typical of phones.
Device draw_device(Random& random);

/// Turns the truth of a walk into what a phone's motion sensors say.
///
/// Attitude is a smooth function of time (carrying mode, sway of the gait); the gyroscope is its derivative, the
/// accelerometer gravity plus the gait's bounce, the magnetometer the local field with the building's anomalies.
class MotionSensors {
 public:
  MotionSensors(const World& world, const Walker& walker, Device device, Carrying carrying, Random random);

  /// The sensors at `since_start`, stamped `time`.
  MargSample sample(Duration since_start, PhoneTime time);
  /// Where the phone really points, body -> true east/north/up.
  Quaternion attitude(Duration since_start) const;

 private:
  Vector3 specific_force_enu(const Truth& truth) const;
  Vector3 field_enu(const Place& place) const;
  Vector3 noisy(const Vector3& value, double sigma);

  const World& world_;
  const Walker& walker_;
  Device device_;
  Carrying carrying_;
  Random random_;
  double bounce_;   // this walker's
};

}  // namespace wayfuse::simulator
