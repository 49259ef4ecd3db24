#include "sdk/src/attitude/complementary_heading.hpp"

#include <algorithm>
#include <numbers>

namespace wayfuse {
namespace {

constexpr double kDriftRadps = 0.005;      // gyroscope-only heading: bias of a phone not calibrated
constexpr double kStillRadps = 0.05;

double drifted_sigma(double start_rad, double drift_s) {
  return std::min(std::numbers::pi, start_rad + kDriftRadps * drift_s);
}

}  // namespace

void ComplementaryHeading::feed(const MargSample& sample) {
  if (const auto turn_rate = gate_.turn_rate(sample)) turn(*turn_rate);
  if (const auto acceleration = gate_.acceleration(sample)) level(*acceleration);
  if (const auto field = gate_.field(sample)) point(field->value);
  time_ = std::max(time_, sample.time);
}

// Trapezoid over the interval; after a gap the turn is unknown, so gravity and compass start afresh.
void ComplementaryHeading::turn(const SampleGate::Passed& turn_rate) {
  if (turn_rate.dt_s > settings_.gap_s) {
    level_ = pointed_ = false;
  } else if (level_) {
    q_ = normalized(q_ * from_rotation_vector((turn_rate_radps_ + turn_rate.value) * (0.5 * turn_rate.dt_s)));
    drift_s_ += turn_rate.dt_s;
  }
  turn_rate_radps_ = turn_rate.value;
}

void ComplementaryHeading::level(const SampleGate::Passed& acceleration) {
  const double length = norm(acceleration.value);
  if (length < 1.0) return;  // free fall: no vertical to be had
  if (!level_) {
    q_ = to_up(acceleration.value * (1.0 / length));
    gravity_enu_ = {0, 0, length};
    averaged_s_ = 0.0;
    level_ = true;
    return;
  }
  // A growing window at the start, then an exponential one.
  averaged_s_ = std::min(averaged_s_ + acceleration.dt_s, settings_.tilt_time_s);
  const double gain = averaged_s_ > 0.0 ? std::min(1.0, acceleration.dt_s / averaged_s_) : 0.0;
  gravity_enu_ = gravity_enu_ + (rotate(q_, acceleration.value) - gravity_enu_) * gain;
  const double gravity = norm(gravity_enu_);
  if (gravity < 1.0) return;
  const Quaternion correction = to_up(gravity_enu_ * (1.0 / gravity));
  q_ = normalized(correction * q_);
  gravity_enu_ = {0, 0, gravity};
}

// [P1 eqs. 6-8, 10]: the field's horizontal part points at magnetic north.
void ComplementaryHeading::point(Vector3 field_ut) {
  if (!level_) return;
  const Vector3 field_enu = rotate(q_, field_ut);
  if (field_enu.x * field_enu.x + field_enu.y * field_enu.y < 1.0) return;  // under 1 microtesla: no direction
  const double away_rad = std::atan2(field_enu.x, field_enu.y);
  q_ = normalized(about_up((pointed_ ? settings_.magnetic_weight : 1.0) * away_rad) * q_);
  const double turned = (pointed_ ? settings_.magnetic_weight : 1.0) * away_rad;
  gravity_enu_ = rotate(about_up(turned), gravity_enu_);
  pointed_ = true;
  drift_s_ = 0.0;
}

std::optional<Attitude> ComplementaryHeading::attitude() const {
  if (!level_) return std::nullopt;
  Attitude attitude;
  attitude.time = time_;
  attitude.body_to_enu = attitude.body_to_level = q_;
  attitude.magnetic_quality = pointed_ ? 1.0 : 0.0;
  attitude.heading = heading_of(q_);
  attitude.heading_sigma_rad = drifted_sigma(pointed_ ? settings_.heading_sigma_rad : std::numbers::pi, drift_s_);
  attitude.inclination_sigma_rad = 0.05;
  attitude.reference = pointed_ ? HeadingReference::kMagnetic : HeadingReference::kArbitrary;
  attitude.turn_rate_radps = turn_rate_radps_;
  attitude.at_rest = norm(turn_rate_radps_) < kStillRadps;
  refer_to(expected_, attitude);
  return attitude;
}

void PrintedComplementaryHeading::feed(const MargSample& sample) {
  if (const auto turn_rate = gate_.turn_rate(sample)) {
    if (turn_rate->dt_s <= settings_.gap_s) heading_rad_ += turn_rate->value.z * turn_rate->dt_s;  // [P1 eq. 9]
    turn_rate_radps_ = turn_rate->value;
  }
  if (const auto acceleration = gate_.acceleration(sample)) {
    const double length = norm(acceleration->value);
    if (length > 1.0) {
      pitch_rad_ = std::asin(std::clamp(acceleration->value.y / length, -1.0, 1.0));  // [P1 eq. 4]
      roll_rad_ = std::asin(std::clamp(acceleration->value.x / length, -1.0, 1.0));   // [P1 eq. 5]
      level_ = true;
    }
  }
  if (const auto field = gate_.field(sample); field && level_) {
    const Quaternion tilt = from_rotation_vector({pitch_rad_, 0, 0}) * from_rotation_vector({0, -roll_rad_, 0});
    const Vector3 flat = rotate(tilt, field->value);                                   // [P1 eqs. 6-7]
    const double magnetic_rad = std::numbers::pi / 2 + std::atan2(flat.x, flat.y);     // [P1 eq. 8]
    const double weight = pointed_ ? settings_.magnetic_weight : 1.0;
    heading_rad_ = wrap_angle_rad(heading_rad_ + weight * wrap_angle_rad(magnetic_rad - heading_rad_));  // [P1 eq. 10]
    pointed_ = true;
  }
  time_ = std::max(time_, sample.time);
}

std::optional<Attitude> PrintedComplementaryHeading::attitude() const {
  if (!level_) return std::nullopt;
  Attitude attitude;
  attitude.time = time_;
  attitude.body_to_enu = about_up(heading_rad_ - std::numbers::pi / 2) * from_rotation_vector({pitch_rad_, 0, 0}) *
                         from_rotation_vector({0, -roll_rad_, 0});
  attitude.body_to_level = attitude.body_to_enu;
  attitude.magnetic_quality = pointed_ ? 1.0 : 0.0;
  attitude.heading = Heading::from_radians(heading_rad_);
  attitude.heading_sigma_rad = pointed_ ? settings_.heading_sigma_rad : std::numbers::pi;
  attitude.inclination_sigma_rad = 0.2;
  attitude.reference = pointed_ ? HeadingReference::kMagnetic : HeadingReference::kArbitrary;
  attitude.turn_rate_radps = turn_rate_radps_;
  attitude.at_rest = norm(turn_rate_radps_) < kStillRadps;
  refer_to(expected_, attitude);
  return attitude;
}

void CompassHeading::feed(const MargSample& sample) {
  if (const auto turn_rate = gate_.turn_rate(sample)) turn_rate_radps_ = turn_rate->value;
  if (const auto acceleration = gate_.acceleration(sample)) acceleration_ = acceleration->value;
  if (const auto field = gate_.field(sample)) field_ = field->value;
  time_ = std::max(time_, sample.time);
}

std::optional<Attitude> CompassHeading::attitude() const {
  if (!acceleration_ || norm(*acceleration_) < 1.0) return std::nullopt;
  Attitude attitude;
  attitude.time = time_;
  attitude.body_to_enu = to_up(*acceleration_ * (1.0 / norm(*acceleration_)));
  attitude.body_to_level = attitude.body_to_enu;
  attitude.reference = HeadingReference::kArbitrary;
  attitude.heading_sigma_rad = std::numbers::pi;
  if (field_) {
    const Vector3 flat = rotate(attitude.body_to_enu, *field_);
    if (flat.x * flat.x + flat.y * flat.y >= 1.0) {
      attitude.body_to_enu = about_up(std::atan2(flat.x, flat.y)) * attitude.body_to_enu;
      attitude.reference = HeadingReference::kMagnetic;
      attitude.heading_sigma_rad = 0.35;
      attitude.magnetic_quality = 1.0;
    }
  }
  attitude.heading = heading_of(attitude.body_to_enu);
  attitude.inclination_sigma_rad = 0.2;
  attitude.turn_rate_radps = turn_rate_radps_;
  attitude.at_rest = norm(turn_rate_radps_) < kStillRadps;
  refer_to(expected_, attitude);
  return attitude;
}

}  // namespace wayfuse
