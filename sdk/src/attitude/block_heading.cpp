#include "sdk/src/attitude/block_heading.hpp"

#include <algorithm>
#include <numbers>

namespace wayfuse {
namespace {

constexpr double kGravity = 9.81;
constexpr double kAheadMost_s = 0.05;  // a turn rate is not carried further

// exp of half an angle vector by its series: an angle a sample turns through is small; a large one in halves.
Quaternion small_turn(Vector3 angle_rad) {
  const double square = dot(angle_rad, angle_rad);
  if (square > 0.25) {
    const Quaternion half = small_turn(angle_rad * 0.5);
    return half * half;
  }
  const double s = 0.5 - square * (1.0 / 48.0 - square * (1.0 / 3840.0));
  return {1.0 - square * (0.125 - square * (1.0 / 384.0)), angle_rad.x * s, angle_rad.y * s, angle_rad.z * s};
}

void to_matrix(Quaternion q, Matrix3& r) {
  const double x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
  const double xx = q.x * x2, yy = q.y * y2, zz = q.z * z2, xy = q.x * y2, xz = q.x * z2, yz = q.y * z2;
  const double wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
  r[0][0] = 1.0 - yy - zz, r[0][1] = xy - wz, r[0][2] = xz + wy;
  r[1][0] = xy + wz, r[1][1] = 1.0 - xx - zz, r[1][2] = yz - wx;
  r[2][0] = xz - wy, r[2][1] = yz + wx, r[2][2] = 1.0 - xx - yy;
}

Vector3 times(const Matrix3& r, Vector3 v) {
  return {r[0][0] * v.x + r[0][1] * v.y + r[0][2] * v.z, r[1][0] * v.x + r[1][1] * v.y + r[1][2] * v.z,
          r[2][0] * v.x + r[2][1] * v.y + r[2][2] * v.z};
}

}  // namespace

BlockHeading::BlockHeading(const BlockHeadingSettings& settings) : settings_(settings) {
  state_.kalman.start(settings_.inertial, {}, 0.0);
}

void BlockHeading::start_with(const SensorCalibration& known) {
  // Since it was learnt, temperature and time have moved the bias: never surer than a tenth of the usual start.
  const double usual = settings_.inertial.bias_sigma_radps;
  const double sigma = known.bias_sigma_radps > 0.0 ? std::clamp(known.bias_sigma_radps, 0.1 * usual, usual) : usual;
  if (finite(known.turn_rate_bias_radps)) state_.kalman.start(settings_.inertial, known.turn_rate_bias_radps, sigma);
  if (finite(known.field_offset_ut)) state_.hard_iron.offset_ut = known.field_offset_ut;
}

std::optional<SensorCalibration> BlockHeading::calibration() const {
  const InertialKalman& kalman = state_.kalman;
  constexpr int kBias = InertialKalman::kBias;
  const double variance = (kalman.p[kBias][kBias] + kalman.p[kBias + 1][kBias + 1] + kalman.p[kBias + 2][kBias + 2]) / 3.0;
  return SensorCalibration{kalman.bias_radps, std::sqrt(variance), state_.hard_iron.offset_ut};
}

bool BlockHeading::silent(PhoneTime now) const { return seconds(now - state_.rate_time) > settings_.gap_s; }

// After a gap: tilt from gravity again, heading from the compass again. The bias stays.
void BlockHeading::start_anew() {
  BlockHeadingState& s = state_;
  InertialKalman fresh;
  fresh.start(settings_.inertial, s.kalman.bias_radps, std::sqrt(s.kalman.p[5][5]));
  s.kalman = fresh;
  s.level = s.compass.pointed = false;
  s.hard_iron.clear();
  clear_block();
}

void BlockHeading::feed(const MargSample& sample) {
  BlockHeadingState& s = state_;
  const std::uint64_t used = s.gate.counts.used;
  if (used == 0) s.rate_time = sample.time;
  if (const auto rate = s.gate.turn_rate(sample)) {
    if (silent(sample.time)) start_anew();
    else if (s.level) turn(rate->value, rate->dt_s);
    s.rate_radps = rate->value;
    s.rate_time = sample.time;
  }
  const bool alone = silent(sample.time);
  if (const auto force = s.gate.acceleration(sample)) {
    if (!s.level && norm(force->value) >= 1.0) {
      s.q = {};
      s.slow_force = force->value;
      s.slow_rate = s.rate_radps;
      level();
    }
    if (alone && s.level) level_alone(force->value, force->dt_s);
    else if (s.level) sense_force(force->value);
  }
  if (const auto field = s.gate.field(sample); field && s.level) {
    sense_field(field->value);
    if (alone) point_alone(field->dt_s);
  }
  if (s.gate.counts.used != used) s.time = std::max(s.time, sample.time);
  if (s.block_s >= settings_.block_s && (s.rates >= settings_.block_samples || s.block_s >= settings_.block_most_s)) close_block();
}

void BlockHeading::turn(Vector3 rate, double dt_s) {
  BlockHeadingState& s = state_;
  const Vector3 before = s.rate_radps - s.kalman.bias_radps, now = rate - s.kalman.bias_radps;
  const Vector3 angle = (before + now) * (0.5 * dt_s) + cross(before, now) * (dt_s * dt_s / 12.0);
  s.q = s.q * small_turn(angle);
  s.rotation_fresh = false;
  s.block_s += dt_s;
  s.rates += 1.0;
  s.rate_sum = s.rate_sum + rate;
  s.square_rate += dot(rate, rate);
}

const Matrix3& BlockHeading::rotation() {
  if (!state_.rotation_fresh) {
    to_matrix(state_.q, state_.rotation);
    state_.rotation_fresh = true;
  }
  return state_.rotation;
}

// Up is where slow_force points.
void BlockHeading::level() {
  BlockHeadingState& s = state_;
  s.q = normalized(to_up(rotate(s.q, s.slow_force * (1.0 / std::max(1.0, norm(s.slow_force))))) * s.q);
  s.level = true;
  s.rotation_fresh = false;
}

void BlockHeading::sense_force(Vector3 force) {
  BlockHeadingState& s = state_;
  s.inertial_force_sum = s.inertial_force_sum + times(rotation(), force);
  s.forces += 1.0;
  s.force_sum = s.force_sum + force;
  s.square_force += dot(force, force);
}

void BlockHeading::sense_field(Vector3 field) {
  BlockHeadingState& s = state_;
  const Matrix3& r = rotation();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) s.magnetic.rotation[i][j] += r[i][j];
  }
  s.magnetic.inertial = s.magnetic.inertial + times(r, field);
  s.magnetic.body = s.magnetic.body + field;
  s.magnetic.square += dot(field, field);
  s.magnetic.count += 1.0;
}

// Without a gyroscope: up is where smoothed gravity says, north where the smoothed compass says.
void BlockHeading::level_alone(Vector3 force, double dt_s) {
  BlockHeadingState& s = state_;
  s.slow_force = s.slow_force + (force - s.slow_force) * std::min(1.0, dt_s / settings_.alone_s);
  s.at_rest = false;
  s.rate_radps = s.kalman.bias_radps;  // as far as anyone knows it does not turn
  level();
}

void BlockHeading::point_alone(double dt_s) {
  BlockHeadingState& s = state_;
  const double gain = s.compass.pointed ? std::min(1.0, dt_s / settings_.alone_s) : 1.0;
  s.compass.average(s.magnetic, 0.0, gain, dt_s);
  s.kalman.p[InertialKalman::kHeading][InertialKalman::kHeading] = settings_.alone_sigma_rad * settings_.alone_sigma_rad;
  clear_block();
}

// Rest: every reading of the block stays close to a slow mean, for long enough.
void BlockHeading::detect_rest(double dt_s) {
  BlockHeadingState& s = state_;
  const auto deviation = [](double n, Vector3 sum, double square, Vector3 mean) {
    return std::max(0.0, square / n - 2.0 * dot(sum, mean) / n + dot(mean, mean));
  };
  const double rate = deviation(s.rates, s.rate_sum, s.square_rate, s.slow_rate);
  const double force = deviation(s.forces, s.force_sum, s.square_force, s.slow_force);
  const double gain = std::min(1.0, dt_s / 0.5);
  s.slow_rate = s.slow_rate + (s.rate_sum * (1.0 / s.rates) - s.slow_rate) * gain;
  s.slow_force = s.slow_force + (s.force_sum * (1.0 / s.forces) - s.slow_force) * gain;
  const double bias_most = settings_.inertial.bias_most_radps;
  const bool still = rate < settings_.rest_rate_radps * settings_.rest_rate_radps &&
                     force < settings_.rest_force_mps2 * settings_.rest_force_mps2 && std::abs(s.slow_rate.x) < bias_most &&
                     std::abs(s.slow_rate.y) < bias_most && std::abs(s.slow_rate.z) < bias_most;
  s.still_s = still ? s.still_s + dt_s : 0.0;
  s.at_rest = s.still_s >= settings_.rest_after_s;
}

void BlockHeading::follow_field(double dt_s) {
  BlockHeadingState& s = state_;
  const HardIron::News news = s.hard_iron.add(settings_.hard_iron, s.magnetic, dt_s);
  if (news == HardIron::News::kStep) {
    s.compass.freeze(s.hard_iron.offset_ut);
  }
  const double weight = s.compass.judge(settings_.magnetic, s.magnetic, s.hard_iron.offset_ut, dt_s);
  double& variance = s.kalman.p[InertialKalman::kHeading][InertialKalman::kHeading];
  if (s.compass.switched) variance = std::max(variance, settings_.switch_sigma_rad * settings_.switch_sigma_rad);
  const MagneticHeadingSettings& m = settings_.magnetic;
  const double away = s.compass.away_rad(s.magnetic, s.hard_iron.offset_ut);
  const double doubt = 1.0 + away * away / (m.turn_scale_rad * m.turn_scale_rad + 4.0 * variance);
  const double noise = m.heading_sigma_rad_rts * m.heading_sigma_rad_rts * doubt * doubt / (dt_s * std::max(weight, 1e-6));
  const double gain = s.compass.pointed ? variance / (variance + noise) : 1.0;
  const double bent = m.bias_spread_rad * m.bias_spread_rad;
  s.compass.average(s.magnetic, away, gain, dt_s);
  s.kalman.pointed(away, noise, gain, bent / (bent + s.compass.spread_rad2));
}

void BlockHeading::close_block() {
  BlockHeadingState& s = state_;
  const double dt_s = s.block_s;
  if (s.forces > 0.0 && s.rates > 0.0) {
    const double n = 1.0 / s.forces;
    detect_rest(dt_s);
    Vector3 correction;
    s.kalman.predict(settings_.inertial, dt_s, rotation(), s.inertial_force_sum * n, s.square_rate / s.rates);
    const double excess = std::sqrt(s.square_force * n) - kGravity;
    s.shake += std::min(1.0, dt_s) * (excess * excess - s.shake);
    s.kalman.stay(settings_.inertial, dt_s, s.at_rest, s.shake, correction);
    if (s.at_rest) s.kalman.rest(settings_.inertial, dt_s, s.rate_sum * (1.0 / s.rates), correction);
    s.q = normalized(small_turn(correction) * s.q);
    s.rotation_fresh = false;
  }
  if (s.magnetic.count > 0.0) follow_field(dt_s);
  clear_block();
}

void BlockHeading::clear_block() {
  BlockHeadingState& s = state_;
  s.block_s = s.rates = s.square_rate = s.forces = s.square_force = 0.0;
  s.rate_sum = s.force_sum = s.inertial_force_sum = {};
  s.magnetic = {};
}

void BlockHeading::expect(const MagneticField& field) {
  state_.expected = field;
  if (field.norm_ut <= 0.0) return;
  state_.compass.norm_ut = field.norm_ut;
  state_.compass.dip_rad = field.dip_rad;
  state_.compass.averaged_s = settings_.magnetic.reference_s;
  state_.compass.support_s = settings_.expected_support_s;
}

std::optional<Attitude> BlockHeading::attitude() const {
  const BlockHeadingState& s = state_;
  if (!s.level) return std::nullopt;
  Attitude attitude;
  attitude.time = s.time;
  attitude.turn_rate_radps = s.rate_radps - s.kalman.bias_radps;
  // The newest turn rate still holds now, and was told late by its own filter.
  const double ahead_s = settings_.sensor_delay_s + std::min(kAheadMost_s, seconds(s.time - s.rate_time));
  Quaternion q = normalized(s.q * small_turn(attitude.turn_rate_radps * ahead_s));
  attitude.body_to_level = q;
  if (s.compass.pointed) q = about_up(s.compass.heading_rad(s.hard_iron.offset_ut)) * q;
  double variance = s.kalman.p[InertialKalman::kHeading][InertialKalman::kHeading];
  if (s.compass.pointed) {
    variance += settings_.magnetic.field_sigma_rad * settings_.magnetic.field_sigma_rad + settings_.magnetic.spread_share * s.compass.spread_rad2;
  }
  attitude.body_to_enu = q;
  attitude.heading = heading_of(q);
  attitude.heading_sigma_rad = std::min(std::numbers::pi, std::sqrt(variance));
  attitude.inclination_sigma_rad = std::sqrt(s.kalman.p[0][0] + s.kalman.p[1][1]);
  attitude.reference = s.compass.pointed ? HeadingReference::kMagnetic : HeadingReference::kArbitrary;
  attitude.at_rest = s.at_rest;
  attitude.magnetic_quality = s.compass.quality;
  refer_to(s.expected, attitude);
  return attitude;
}

}  // namespace wayfuse
