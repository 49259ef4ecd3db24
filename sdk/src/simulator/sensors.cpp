#include "sdk/src/simulator/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wayfuse::simulator {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kGravity_mps2 = 9.80665;

Quaternion times(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Quaternion conjugate(const Quaternion& q) { return {q.w, -q.x, -q.y, -q.z}; }

Vector3 rotate(const Quaternion& q, const Vector3& v) {
  const Quaternion r = times(times(q, {0, v.x, v.y, v.z}), conjugate(q));
  return {r.x, r.y, r.z};
}

Quaternion about_x(double angle_rad) { return {std::cos(angle_rad / 2), std::sin(angle_rad / 2), 0, 0}; }
Quaternion about_y(double angle_rad) { return {std::cos(angle_rad / 2), 0, std::sin(angle_rad / 2), 0}; }
Quaternion about_z(double angle_rad) { return {std::cos(angle_rad / 2), 0, 0, std::sin(angle_rad / 2)}; }

struct Pose {
  double yaw_rad, pitch_rad, roll_rad;   // of the phone against the walker
  double sway_rad;                       // yaw swing with every second step
  double swing_rad;                      // pitch swing of an arm or leg
};

Pose pose_of(Carrying carrying) {
  switch (carrying) {
    case Carrying::kTexting: return {0.0, 0.60, 0.03, 0.04, 0.02};
    case Carrying::kPhoning: return {0.3, 1.20, 1.10, 0.05, 0.03};
    case Carrying::kPocket: return {0.4, 1.45, 0.15, 0.10, 0.35};
    case Carrying::kSwinging: return {0.1, 0.20, 1.35, 0.12, 0.50};
  }
  return {};
}

}  // namespace

Device draw_device(Random& random) {
  constexpr const char* kModels[] = {"stand-in A", "stand-in B", "stand-in C", "stand-in D"};
  Device device;
  const std::uint64_t model = random.below(std::size(kModels));
  device.model = kModels[model];
  device.rss_offset_db = -4.0 + 2.5 * static_cast<double>(model) + 0.8 * random.normal();
  const auto vector = [&](double sigma) { return Vector3{sigma * random.normal(), sigma * random.normal(), sigma * random.normal()}; };
  device.gyro_bias_radps = vector(0.004);
  device.hard_iron_ut = vector(1.5);
  return device;
}

MotionSensors::MotionSensors(const World& world, const Walker& walker, Device device, Carrying carrying, Random random)
    : world_(world), walker_(walker), device_(std::move(device)), carrying_(carrying), random_(random) {
  bounce_ = 1.0 + 0.12 * random_.normal();
}

Quaternion MotionSensors::attitude(Duration since_start) const {
  const Truth truth = walker_.at(since_start);
  const Pose pose = pose_of(carrying_);
  const double stride = kPi * truth.gait_phase;   // one turn of 2 pi = two steps
  const double moving = std::min(1.0, truth.speed_mps / 0.5);
  // Body y points where the walker goes; the body's yaw is measured from north, counter-clockwise.
  const double north_yaw = world_.georeference.to_true(truth.heading).radians() - kPi / 2;
  const double yaw = north_yaw + pose.yaw_rad + moving * pose.sway_rad * std::sin(stride);
  const double pitch = pose.pitch_rad + moving * pose.swing_rad * std::sin(stride + 0.7);
  return times(times(about_z(yaw), about_x(pitch)), about_y(pose.roll_rad + moving * 0.02 * std::sin(stride + 1.3)));
}

// Two bounces a stride upwards, a push and a brake a step forwards, a sway a stride sideways.
Vector3 MotionSensors::specific_force_enu(const Truth& truth) const {
  const double step = 2 * kPi * truth.gait_phase;
  const double vigour = bounce_ * std::pow(std::min(truth.speed_mps, 2.0) / 1.25, 1.5);
  const double up = vigour * (2.4 * std::cos(step) + 0.8 * std::cos(2 * step + 0.6) + 0.25 * std::cos(3 * step));
  // Inverted pendulum: fastest at the lowest point, so the push leads the upward acceleration by a quarter of a step.
  const double forward = -vigour * 1.1 * std::sin(step + 0.4);
  const double side = vigour * 0.6 * std::sin(step / 2);
  const Heading heading = world_.georeference.to_true(truth.heading);
  return {forward * heading.cos() - side * heading.sin(), forward * heading.sin() + side * heading.cos(), kGravity_mps2 + up};
}

Vector3 MotionSensors::field_enu(const Place& place) const {
  const MagneticField& field = world_.magnetic_field;
  const double horizontal = field.norm_ut * std::cos(field.dip_rad);
  Vector3 sum{horizontal * std::sin(field.declination_rad), horizontal * std::cos(field.declination_rad),
              -field.norm_ut * std::sin(field.dip_rad)};
  for (const MagneticAnomaly& anomaly : world_.anomalies) {
    if (anomaly.place.floor != place.floor) continue;
    const double far_m = distance_m(anomaly.place.point, place.point) / anomaly.reach_m;
    const double strength_ut = anomaly.strength_ut * std::exp(-0.5 * far_m * far_m);
    const Heading direction = world_.georeference.to_true(anomaly.direction);
    sum.x += strength_ut * direction.cos();
    sum.y += strength_ut * direction.sin();
    sum.z += 0.7 * strength_ut;
  }
  return sum;
}

Vector3 MotionSensors::noisy(const Vector3& value, double sigma) {
  const double x = value.x + sigma * random_.normal();
  const double y = value.y + sigma * random_.normal();
  const double z = value.z + sigma * random_.normal();
  return {x, y, z};
}

MargSample MotionSensors::sample(Duration since_start, PhoneTime time) {
  constexpr Duration kHalf = std::chrono::milliseconds(5);
  const Truth truth = walker_.at(since_start);
  const Quaternion now = attitude(since_start);
  const Quaternion to_body = conjugate(now);
  const Duration before = std::max(Duration{0}, since_start - kHalf), after = since_start + kHalf;
  const Quaternion turn = times(conjugate(attitude(before)), attitude(after));
  const double sign = turn.w < 0 ? -2.0 : 2.0;
  const double per_s = sign / seconds(after - before);
  Vector3 rate{turn.x * per_s + device_.gyro_bias_radps.x, turn.y * per_s + device_.gyro_bias_radps.y,
               turn.z * per_s + device_.gyro_bias_radps.z};
  Vector3 field = rotate(to_body, field_enu(truth.place));
  field = {field.x + device_.hard_iron_ut.x, field.y + device_.hard_iron_ut.y, field.z + device_.hard_iron_ut.z};
  MargSample sample;
  sample.time = time;
  sample.acceleration_mps2 = noisy(rotate(to_body, specific_force_enu(truth)), device_.acceleration_noise_mps2);
  sample.turn_rate_radps = noisy(rate, device_.gyro_noise_radps);
  sample.field_ut = noisy(field, device_.field_noise_ut);
  // The barometric formula near the ground: 8.3 m a hPa.
  sample.pressure_hpa = 1013.25 - truth.height_m / 8.3 + 0.02 * random_.normal();
  return sample;
}

}  // namespace wayfuse::simulator
