#pragma once

#include <optional>

#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Three axes of a phone's body frame: x right, y up along the screen, z out of the screen (Android's axes).
struct Vector3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  bool operator==(const Vector3&) const = default;
};

/// One reading of the motion sensors. A sensor that did not speak at this instant is absent.
struct MargSample {
  PhoneTime time;                           ///< when it was sampled
  std::optional<Vector3> acceleration_mps2; ///< specific force: +9.81 upwards when lying still
  std::optional<Vector3> turn_rate_radps;
  std::optional<Vector3> field_ut;          ///< microtesla, uncalibrated or calibrated
  std::optional<double> pressure_hpa;
  bool operator==(const MargSample&) const = default;
};

}  // namespace wayfuse
