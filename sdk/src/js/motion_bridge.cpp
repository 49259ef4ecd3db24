// What JavaScript calls: the motion core behind plain functions and one array of numbers each way. wayfuse.mjs is its only user
// and knows the order of the numbers.

#include <string>

#include "wayfuse/sdk/motion_tracker.hpp"

namespace {

using namespace wayfuse;

enum Has : unsigned { kAcceleration = 1, kTurnRate = 2, kField = 4, kPressure = 8 };

struct Motion {
  MotionTracker tracker;
  double in[12];    // time_us, has, acceleration 3, turn rate 3, field 3, pressure
  double out[20];
};

Vector3 vector_at(const double* v) { return {v[0], v[1], v[2]}; }

double micros(PhoneTime time) { return static_cast<double>(time.time_since_epoch().count()); }

}  // namespace

extern "C" {

Motion* wf_motion_create(const char* heading_estimator) {
  MotionTrackerSettings settings;
  if (*heading_estimator != '\0') settings.heading_estimator = heading_estimator;
  auto tracker = MotionTracker::create(settings);
  return tracker ? new Motion{std::move(tracker).value(), {}, {}} : nullptr;
}

void wf_motion_destroy(Motion* motion) { delete motion; }
double* wf_motion_in(Motion* motion) { return motion->in; }
double* wf_motion_out(Motion* motion) { return motion->out; }

void wf_motion_expect(Motion* motion, double declination_rad, double dip_rad, double norm_ut) {
  motion->tracker.expect({declination_rad, dip_rad, norm_ut});
}

/// 1 = a report is in `out`.
int wf_motion_feed(Motion* motion) {
  const double* in = motion->in;
  const auto has = static_cast<unsigned>(in[1]);
  MargSample sample;
  sample.time = PhoneTime{Duration{static_cast<std::int64_t>(in[0])}};
  if (has & kAcceleration) sample.acceleration_mps2 = vector_at(in + 2);
  if (has & kTurnRate) sample.turn_rate_radps = vector_at(in + 5);
  if (has & kField) sample.field_ut = vector_at(in + 8);
  if (has & kPressure) sample.pressure_hpa = in[11];
  const auto report = motion->tracker.feed(sample);
  if (!report) return 0;
  double* out = motion->out;
  *out++ = micros(report->time);
  *out++ = static_cast<double>(report->interval.count());
  *out++ = report->steps;
  *out++ = report->step_length_m;
  *out++ = report->distance_m();
  *out++ = report->heading.radians();
  *out++ = report->heading_sigma_rad;
  *out++ = static_cast<double>(report->reference);
  *out++ = report->turn_rate_radps;
  *out++ = report->at_rest ? 1.0 : 0.0;
  return 1;
}

/// 1 = an attitude is in `out`: w, x, y, z body to east-north-up, heading and its sigma, quality of the field.
int wf_motion_attitude(Motion* motion) {
  const auto attitude = motion->tracker.attitude();
  if (!attitude) return 0;
  double* out = motion->out;
  for (const double part : {attitude->body_to_enu.w, attitude->body_to_enu.x, attitude->body_to_enu.y, attitude->body_to_enu.z,
                            attitude->heading.radians(), attitude->heading_sigma_rad, attitude->magnetic_quality}) {
    *out++ = part;
  }
  return 1;
}

/// Walking, steps, cadence, step length, speed and its sigma, carrying, climbing in `out`.
void wf_motion_walk(Motion* motion) {
  const WalkState walk = motion->tracker.walk();
  double* out = motion->out;
  for (const double part : {walk.walking ? 1.0 : 0.0, static_cast<double>(walk.steps), walk.cadence_hz, walk.step_length_m,
                            walk.speed_mps, walk.speed_sigma_mps, static_cast<double>(walk.carrying),
                            static_cast<double>(walk.climbing)}) {
    *out++ = part;
  }
}
}
