#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/random.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse::simulator {

/// One phone model's and specimen's faults.
struct Device {
  std::string model = "stand-in";
  double rss_offset_db = 0.0;          ///< against the surveyor's phone, at -65 dBm
  double rss_gain = 1.0;               ///< how far its levels spread about -65 dBm, 0.5..1.5
  double rss_noise_db = 1.2;           ///< 1 sigma a reading, before rounding to whole dBm
  double sensitivity_dbm = -90.0;      ///< half of the frames at this level are heard
  double acceleration_noise_mps2 = 0.03;
  Vector3 acceleration_bias_mps2;
  double gyro_noise_radps = 0.003;
  Vector3 gyro_bias_radps;
  double field_noise_ut = 0.4;
  Vector3 hard_iron_ut;
  double rate_hz = 50.0;               ///< of the motion sensors, 25..400
  bool barometer = true;

  /// What this phone makes of a true level.
  double told_dbm(double level_dbm) const { return -65.0 + rss_gain * (level_dbm + 65.0) + rss_offset_db; }
};

/// The models there are, each a specimen without faults of its own: "stand-in A" to "stand-in F".
const std::vector<Device>& device_models();
/// A specimen of the named model with faults typical of phones; std::invalid_argument lists the models there are.
Device draw_device(std::string_view model, Random& random);
/// ... of any model.
Device draw_device(Random& random);

}  // namespace wayfuse::simulator
