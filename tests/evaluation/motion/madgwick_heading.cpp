#include "tests/evaluation/motion/madgwick_heading.hpp"

#include <algorithm>

namespace wayfuse {

void MadgwickHeading::start() {
  q_ = to_up(*up_);
  if (field_) {
    const Vector3 flat = rotate(q_, *field_);
    q_ = about_up(std::atan2(flat.x, flat.y)) * q_;
  }
  started_ = true;
}

// Direction of steepest descent of |R' up - measured|^2 + |R' field - measured|^2, the field's own declination taken out.
// With f = R' e - m the gradient of the quaternion is the rotation that turns R' e towards m: q * (0, cross) up to scale.
Quaternion MadgwickHeading::descent() const {
  Vector3 turn{};
  if (up_) turn = turn + cross(*up_, unrotate(q_, {0, 0, 1}));
  if (field_) {
    const Vector3 seen = rotate(q_, *field_);
    const Vector3 reference{0, std::hypot(seen.x, seen.y), seen.z};
    turn = turn + cross(*field_, unrotate(q_, reference));
  }
  const double length = norm(turn);
  if (length < 1e-9) return {0, 0, 0, 0};
  return q_ * Quaternion{0, turn.x / length, turn.y / length, turn.z / length};
}

void MadgwickHeading::feed(const MargSample& sample) {
  const auto unit = [](Vector3 v) { return v * (1.0 / norm(v)); };
  if (const auto force = gate_.acceleration(sample); force && norm(force->value) > 0.5) up_ = unit(force->value);
  if (const auto field = gate_.field(sample); field && norm(field->value) > 0.5) field_ = unit(field->value);
  const auto rate = gate_.turn_rate(sample);
  time_ = std::max(time_, sample.time);
  if (!started_) {
    if (up_ && field_) start();
    return;
  }
  if (!rate || rate->dt_s > 1.0) return;
  rate_ = rate->value;
  const Quaternion by_rate = q_ * Quaternion{0, 0.5 * rate_.x, 0.5 * rate_.y, 0.5 * rate_.z};
  const Quaternion by_descent = descent();
  const double dt = rate->dt_s, step = settings_.beta_radps * dt;
  q_ = normalized({q_.w + by_rate.w * dt + by_descent.w * step, q_.x + by_rate.x * dt + by_descent.x * step,
                   q_.y + by_rate.y * dt + by_descent.y * step, q_.z + by_rate.z * dt + by_descent.z * step});
}

std::optional<Attitude> MadgwickHeading::attitude() const {
  if (!started_) return std::nullopt;
  Attitude attitude;
  attitude.time = time_;
  attitude.body_to_enu = attitude.body_to_level = q_;
  attitude.heading = heading_of(q_);
  attitude.heading_sigma_rad = 0.1;
  attitude.turn_rate_radps = rate_;
  attitude.reference = HeadingReference::kMagnetic;
  refer_to(expected_, attitude);
  return attitude;
}

}  // namespace wayfuse
