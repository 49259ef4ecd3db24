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

constexpr int kWanderWaves = 4;
constexpr double kWanderLeast_s = 8.0, kWanderMost_s = 60.0;   // periods
constexpr double kHandling_s = 1.2;   // from one way of carrying to another

}  // namespace

const std::vector<std::string>& carrying_names() {
  static const std::vector<std::string> names = {"texting", "phoning", "pocket", "swinging"};
  return names;
}

MotionSensors::Pose MotionSensors::pose_of(Carrying carrying) {
  switch (carrying) {
    case Carrying::kTexting: return {0.0, 0.60, 0.03, 0.04, 0.02, 1.25};
    case Carrying::kPhoning: return {0.3, 1.20, 1.10, 0.05, 0.03, 1.60};
    case Carrying::kPocket: return {0.4, 1.45, 0.15, 0.10, 0.35, 0.85};
    case Carrying::kSwinging: return {0.1, 0.20, 1.35, 0.12, 0.50, 0.75};
  }
  return {};
}

MotionSensors::MotionSensors(const World& world, const Walker& walker, Device device, CarryingSettings carrying, Random random)
    : MotionSensors(world, walker, std::move(device), carrying, random, Random(random).split()) {}

// The hand has a generator of its own: gait and noise are the same whatever it does.
MotionSensors::MotionSensors(const World& world, const Walker& walker, Device device, CarryingSettings carrying, Random random,
                             Random of_the_hand)
    : world_(world), walker_(walker), device_(std::move(device)), changes_{{Duration{0}, carrying.mode}}, wander_rad_(carrying.wander_rad),
      random_(random), hand_(of_the_hand) {
  bounce_ = 1.0 + 0.12 * random_.normal();
  for (auto* waves : {&yaw_waves_, &pitch_waves_}) {
    for (int i = 0; i < kWanderWaves; ++i) {
      const double period_s = kWanderLeast_s + (kWanderMost_s - kWanderLeast_s) * random_.uniform();
      waves->push_back({2 * kPi / period_s, 2 * kPi * random_.uniform()});
    }
  }
  hand_.fidget(carrying.fidgets_per_min, walker_.length(), of_the_hand);
  if (carrying.stay <= Duration{0}) return;
  while (changes_.back().at < walker_.length()) {
    const Duration stay = from_seconds(seconds(carrying.stay) * (0.5 + random_.uniform()));
    const auto other = 1 + static_cast<int>(random_.below(kCarryingModes - 1));
    const Carrying from = changes_.back().to, to = static_cast<Carrying>((static_cast<int>(from) + other) % kCarryingModes);
    changes_.push_back({changes_.back().at + stay, to});
    hand_.move(changes_.back().at, pose_of(to).height_m - pose_of(from).height_m, kHandling_s);
  }
}

double MotionSensors::wander(const std::vector<Wave>& waves, Duration since_start) const {
  double sum = 0;
  for (const Wave& wave : waves) sum += std::sin(wave.radps * seconds(since_start) + wave.phase_rad);
  return wander_rad_ * std::sqrt(2.0 / kWanderWaves) * sum;
}

Carrying MotionSensors::carrying(Duration since_start) const {
  const auto after = std::ranges::upper_bound(changes_, since_start, {}, &Change::at);
  return after == changes_.begin() ? changes_.front().to : (after - 1)->to;
}

// Between two modes the hand moves evenly, without a jolt at either end.
MotionSensors::Pose MotionSensors::pose_at(Duration since_start) const {
  const auto after = std::ranges::upper_bound(changes_, since_start, {}, &Change::at);
  if (after - changes_.begin() <= 1) return pose_of(changes_.front().to);
  const double t = std::min(1.0, seconds(since_start - (after - 1)->at) / kHandling_s);
  const double share = t * t * (3 - 2 * t);
  const Pose from = pose_of((after - 2)->to), to = pose_of((after - 1)->to);
  const auto mix = [share](double a, double b) { return a + share * (b - a); };
  return {mix(from.yaw_rad, to.yaw_rad), mix(from.pitch_rad, to.pitch_rad), mix(from.roll_rad, to.roll_rad),
          mix(from.sway_rad, to.sway_rad), mix(from.swing_rad, to.swing_rad), mix(from.height_m, to.height_m)};
}

Quaternion MotionSensors::attitude(Duration since_start) const {
  const Truth truth = walker_.at(since_start);
  const Pose pose = pose_at(since_start);
  const double stride = kPi * truth.gait_phase;   // one turn of 2 pi = two steps
  // Body y points where the walker goes; the body's yaw is measured from north, counter-clockwise.
  const double north_yaw = world_.georeference.to_true(truth.heading).radians() - kPi / 2;
  const double yaw = north_yaw + pose.yaw_rad + wander(yaw_waves_, since_start) + truth.swing * pose.sway_rad * std::sin(stride);
  const double pitch = pose.pitch_rad + wander(pitch_waves_, since_start) + truth.swing * pose.swing_rad * std::sin(stride + 0.7);
  return times(times(about_z(yaw), about_x(pitch)), about_y(pose.roll_rad + truth.swing * 0.02 * std::sin(stride + 1.3)));
}

// Two bounces a stride upwards, a push and a brake a step forwards, a sway a stride sideways.
Vector3 MotionSensors::specific_force_enu(const Truth& truth, double hand_mps2) const {
  const double step = 2 * kPi * truth.gait_phase;
  const double vigour = bounce_ * std::pow(std::min(truth.speed_mps, 2.0) / 1.25, 1.5);
  const double up = vigour * (2.4 * std::cos(step) + 0.8 * std::cos(2 * step + 0.6) + 0.25 * std::cos(3 * step));
  // Inverted pendulum: fastest at the lowest point, so the push leads the upward acceleration by a quarter of a step.
  const double forward = -vigour * 1.1 * std::sin(step + 0.4);
  const double side = vigour * 0.6 * std::sin(step / 2);
  const Heading heading = world_.georeference.to_true(truth.heading);
  return {forward * heading.cos() - side * heading.sin(), forward * heading.sin() + side * heading.cos(), kGravity_mps2 + up + hand_mps2 + truth.lift_mps2};
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
  Vector3 force = rotate(to_body, specific_force_enu(truth, hand_.acceleration_mps2(since_start)));
  force = {force.x + device_.acceleration_bias_mps2.x, force.y + device_.acceleration_bias_mps2.y,
           force.z + device_.acceleration_bias_mps2.z};
  sample.acceleration_mps2 = noisy(force, device_.acceleration_noise_mps2);
  sample.turn_rate_radps = noisy(rate, device_.gyro_noise_radps);
  sample.field_ut = noisy(field, device_.field_noise_ut);
  // The barometric formula near the ground: 8.3 m a hPa.
  const double pressure_hpa = 1013.25 - truth.height_m / 8.3 + 0.02 * random_.normal();
  if (device_.barometer) sample.pressure_hpa = pressure_hpa;
  return sample;
}

}  // namespace wayfuse::simulator
