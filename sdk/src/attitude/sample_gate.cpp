#include "sdk/src/attitude/sample_gate.hpp"

namespace wayfuse {

std::optional<SampleGate::Passed> SampleGate::pass(Sensor& sensor, PhoneTime time, const std::optional<Vector3>& value,
                                                   double most) {
  if (!value) return std::nullopt;
  if (sensor.seen && time <= sensor.last) {
    ++(time == sensor.last ? counts.duplicate : counts.stale);
    return std::nullopt;
  }
  if (!(dot(*value, *value) <= most * most)) {  // NaN, too
    ++(finite(*value) ? counts.overrange : counts.not_finite);
    return std::nullopt;
  }
  const double dt_s = sensor.seen ? seconds(time - sensor.last) : 0.0;
  sensor.last = time;
  sensor.seen = true;
  ++counts.used;
  return Passed{*value, dt_s};
}

}  // namespace wayfuse
