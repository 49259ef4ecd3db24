#pragma once

#include <cstdint>
#include <optional>

#include "sdk/src/attitude/rotation.hpp"
#include "wayfuse/sdk/heading_estimator.hpp"

namespace wayfuse {

/// Lets through what can be used: each sensor's readings in time order, finite and within what a phone can measure.
///
/// A plain struct: copying it saves it.
struct SampleGate {
  static constexpr double kAccelerationMost = 400.0;  ///< length, m/s2; phones end at 160 an axis
  static constexpr double kTurnRateMost = 70.0;       ///< rad/s; phones end at 35 an axis
  static constexpr double kFieldMost = 8600.0;        ///< microtesla; phones end at 4912 an axis

  /// A reading that passed, and the time since the one before it (0 for the first). Lives as long as its sample.
  struct Passed {
    const Vector3& value;
    double dt_s = 0.0;
  };

  std::optional<Passed> acceleration(const MargSample& sample) {
    return pass(acceleration_, sample.time, sample.acceleration_mps2, kAccelerationMost);
  }
  std::optional<Passed> turn_rate(const MargSample& sample) {
    return pass(turn_rate_, sample.time, sample.turn_rate_radps, kTurnRateMost);
  }
  std::optional<Passed> field(const MargSample& sample) { return pass(field_, sample.time, sample.field_ut, kFieldMost); }

  SampleCounts counts;

 private:
  struct Sensor {
    PhoneTime last;
    bool seen = false;
  };
  std::optional<Passed> pass(Sensor& sensor, PhoneTime time, const std::optional<Vector3>& value, double most);

  Sensor acceleration_;
  Sensor turn_rate_;
  Sensor field_;
};

}  // namespace wayfuse
