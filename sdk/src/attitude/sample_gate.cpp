#include "sdk/src/attitude/sample_gate.hpp"

namespace wayfuse {

std::optional<SampleGate::Passed> SampleGate::pass(Sensor& sensor, PhoneTime time, const std::optional<Vector3>& value,
                                                   double most) {
  if (!value) return std::nullopt;
  if (sensor.seen && time <= sensor.last) {
    ++(time == sensor.last ? counts.duplicate : counts.stale);
    return std::nullopt;
  }
  const auto within = [most](double v) { return std::abs(v) <= most; };  // false for NaN, too
  if (!(within(value->x) && within(value->y) && within(value->z))) {
    ++(finite(*value) ? counts.overrange : counts.not_finite);
    return std::nullopt;
  }
  const double dt_s = sensor.seen ? seconds(time - sensor.last) : 0.0;
  sensor.last = time;
  sensor.seen = true;
  ++counts.used;
  return Passed{*value, dt_s};
}

std::optional<SampleGate::Passed> SampleGate::acceleration(const MargSample& sample) {
  return pass(acceleration_, sample.time, sample.acceleration_mps2, kAccelerationMost);
}
std::optional<SampleGate::Passed> SampleGate::turn_rate(const MargSample& sample) {
  return pass(turn_rate_, sample.time, sample.turn_rate_radps, kTurnRateMost);
}
std::optional<SampleGate::Passed> SampleGate::field(const MargSample& sample) {
  return pass(field_, sample.time, sample.field_ut, kFieldMost);
}

}  // namespace wayfuse
