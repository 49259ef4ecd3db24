#include "wayfuse/sdk/motion_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sdk/src/attitude/catalogue.hpp"
#include "sdk/src/attitude/sample_gate.hpp"
#include "sdk/src/walking/climb.hpp"
#include "sdk/src/walking/lift_detector.hpp"
#include "sdk/src/walking/step_length.hpp"
#include "sdk/src/walking/walk_detector.hpp"
#include "sdk/src/walking/walking_direction.hpp"

namespace wayfuse {
namespace {

constexpr double kRestAfterS = 1.5;           // without a step and without shaking
constexpr double kRestDeviation = 0.35;       // m/s2, smoothed mean of | |a| - mean |
constexpr double kTurningRadps = 0.35;        // mean over the interval, 20 degrees a second
constexpr double kStandingSigmaM = 0.1;       // of an interval without steps
constexpr double kGapS = 1.0;
constexpr double kPaceS = 1.1;                // between two steps of a walker
constexpr double kCatchUpS = 0.1;             // steps recognised late come out one by one, so far apart

// From the level frame to the attitude's own axes.
double yaw_from_level_rad(const Attitude& attitude) {
  const Quaternion d = attitude.body_to_enu * conjugate(attitude.body_to_level);
  return 2.0 * std::atan2(d.z, d.w);
}

}  // namespace

struct MotionTracker::State {
  Duration report_interval;
  std::unique_ptr<HeadingEstimator> heading;
  SampleGate gate;
  WalkDetector steps;
  StepLengthSettings length_settings;
  StepLength length;
  WalkingDirectionSettings direction_settings;
  WalkingDirection direction;
  Climb climb;
  LiftDetectorSettings lift_settings;
  LiftDetector lift;
  double mean_mps2 = 9.81, deviation_mps2 = 1.0;
  std::optional<PhoneTime> reported, last_step;
  std::optional<PhoneTime> paced;   // the newest step that followed another at once: a lift that sets off may pass for one
  double turned_rad = 0.0;       // since the last report
  double turned_walk_rad = 0.0;  // since the last acceleration
  std::optional<Vector3> field;
  // Steps counted and not reported yet, oldest first; and where the walker was heading in the last seconds.
  Step waiting[2 * StepBatch::kMost];
  int waiting_count = 0;
  static constexpr int kPast = 64;
  struct Past {
    PhoneTime time;
    Heading level;               // in the level frame, so that a compass correction since then counts
  };
  Past past[kPast];
  int past_next = 0, past_count = 0;
  std::uint64_t step_count = 0;
  double newest_length_m = 0.0;

  void watch_turn(const SampleGate::Passed& rate, const Attitude& attitude);
  StepBatch watch_steps(PhoneTime time, const SampleGate::Passed& acceleration, const std::optional<Attitude>& attitude);
  bool resting(PhoneTime time) const;
  void wait(const StepBatch& batch);
  void remember_heading(const Attitude& attitude);
  Heading heading_at(PhoneTime time, const Attitude& attitude) const;
  void add_step(const Attitude& attitude, MotionReport& report);
  MotionReport report(PhoneTime time, const Attitude& attitude, bool with_step);
};

bool MotionTracker::State::resting(PhoneTime time) const {
  return !steps.walking() && deviation_mps2 < kRestDeviation && (!last_step || seconds(time - *last_step) > kRestAfterS);
}

void MotionTracker::State::watch_turn(const SampleGate::Passed& rate, const Attitude& attitude) {
  if (rate.dt_s > kGapS) return;
  const double turn = rotate(attitude.body_to_level, attitude.turn_rate_radps).z * rate.dt_s;
  turned_rad += turn;
  turned_walk_rad += turn;
  direction.carry(direction_settings, attitude.turn_rate_radps, unrotate(attitude.body_to_level, {0, 0, 1}), rate.dt_s,
                  resting(attitude.time));
}

StepBatch MotionTracker::State::watch_steps(PhoneTime time, const SampleGate::Passed& acceleration,
                                            const std::optional<Attitude>& attitude) {
  const double total = norm(acceleration.value);
  const double gain = std::min(1.0, acceleration.dt_s / 0.7);
  mean_mps2 += gain * (total - mean_mps2);
  deviation_mps2 += gain * (std::abs(total - mean_mps2) - deviation_mps2);
  const StepBatch batch = steps.feed(time, acceleration.value);
  for (int i = 0; i < batch.count; ++i) {
    if (batch.steps[i].interval_s > 0.0 && batch.steps[i].interval_s < kPaceS) paced = batch.steps[i].time;
  }
  if (attitude) {
    const Vector3 level = rotate(attitude->body_to_level, acceleration.value);
    direction.feed(direction_settings, level, turned_walk_rad, acceleration.dt_s, steps.walking());
    lift.feed(lift_settings, {time, acceleration.dt_s, level.z, unrotate(attitude->body_to_level, {0, 0, 1}), paced, climb.above_m()});
  }
  turned_walk_rad = 0.0;
  return batch;
}

void MotionTracker::State::wait(const StepBatch& batch) {
  for (int i = 0; i < batch.count && waiting_count < 2 * StepBatch::kMost; ++i) waiting[waiting_count++] = batch.steps[i];
}

// Five times a second, for the dozen seconds after which a step may still be recognised.
void MotionTracker::State::remember_heading(const Attitude& attitude) {
  if (past_count > 0 && seconds(attitude.time - past[(past_next + kPast - 1) % kPast].time) < 0.2) return;
  const double turn = yaw_from_level_rad(attitude);
  past[past_next] = {attitude.time, direction.direction(direction_settings, attitude, steps.gait().features.swing_mps2).turned_by(-turn)};
  past_next = (past_next + 1) % kPast;
  past_count = std::min(past_count + 1, kPast);
}

Heading MotionTracker::State::heading_at(PhoneTime time, const Attitude& attitude) const {
  for (int k = 1; k <= past_count; ++k) {
    const Past& then = past[(past_next + kPast - k) % kPast];
    if (then.time <= time) return then.level.turned_by(yaw_from_level_rad(attitude));
  }
  return direction.direction(direction_settings, attitude, steps.gait().features.swing_mps2);
}

void MotionTracker::State::add_step(const Attitude& attitude, MotionReport& report) {
  const Step step = waiting[0];
  std::copy(waiting + 1, waiting + waiting_count, waiting);
  --waiting_count;
  // A step recognised at once goes where the walker goes now; a late one where they went then, in the hand before the face.
  if (seconds(report.time - step.time) > 1.0 && direction.carrying == Carrying::kHeld) report.heading = heading_at(step.time, attitude);
  newest_length_m = length.take(length_settings, step);
  length.walked(newest_length_m, newest_length_m * report.heading.cos(), newest_length_m * report.heading.sin());
  ++step_count;
  last_step = step.time;
  report.steps = 1;
  report.step_length_m = newest_length_m;
  report.distance_sigma_m = newest_length_m * std::hypot(length.scale_sigma, length_settings.relative_sigma_step);
}

MotionReport MotionTracker::State::report(PhoneTime time, const Attitude& attitude, bool with_step) {
  MotionReport report;
  const double swing = steps.gait().features.swing_mps2;
  report.time = time;
  report.interval = reported ? time - *reported : Duration{0};
  report.heading = direction.direction(direction_settings, attitude, swing);
  report.heading_sigma_rad = direction.sigma_rad(direction_settings, attitude, swing);
  report.reference = attitude.reference;
  const double interval_s = seconds(report.interval);
  report.turn_rate_radps = interval_s > 0.0 ? std::clamp(turned_rad / interval_s, -35.0, 35.0) : 0.0;
  report.turning = std::abs(report.turn_rate_radps) > kTurningRadps;
  report.distance_sigma_m = kStandingSigmaM;
  report.at_rest = !with_step && waiting_count == 0 && resting(time) && !lift.riding();   // what it hears changes with the floors
  if (with_step) add_step(attitude, report);
  if (report.at_rest) report.distance_sigma_m = 0.02;
  const std::optional<double> lifted_m = lift.take();
  report.climb_m = climb.take();
  if (!report.climb_m) report.climb_m = lifted_m;
  if (field) {
    const Vector3 enu = rotate(attitude.body_to_enu, *field);
    report.field_horizontal_ut = std::hypot(enu.x, enu.y);
    report.field_vertical_ut = -enu.z;
  }
  reported = time;
  turned_rad = 0.0;
  return report;
}

Result<MotionTracker> MotionTracker::create(const MotionTrackerSettings& settings) {
  if (settings.report_interval <= Duration{0} || settings.report_interval > std::chrono::seconds(60)) {
    return Fault{FaultCode::kOutOfRange, "report_interval", std::to_string(seconds(settings.report_interval)) + " s is outside 0..60 s"};
  }
  auto heading = make_heading_estimator(settings.heading_estimator);
  if (!heading) return heading.fault();
  auto state = std::make_unique<State>();
  state->report_interval = settings.report_interval;
  state->heading = std::move(heading).value();
  if (const auto& known = settings.calibration) {
    if (!(known->step_scale >= 0.7 && known->step_scale <= 1.4)) {
      return Fault{FaultCode::kOutOfRange, "calibration.step_scale", std::to_string(known->step_scale) + " is outside 0.7..1.4"};
    }
    state->heading->start_with(known->sensors);
    state->length.scale = known->step_scale;
    state->length.scale_sigma = std::clamp(known->step_scale_sigma, 0.02, 0.10);
  }
  return MotionTracker(std::move(state));
}

MotionTracker::MotionTracker(std::unique_ptr<State> state) : state_(std::move(state)) {}
MotionTracker::MotionTracker(MotionTracker&&) noexcept = default;
MotionTracker& MotionTracker::operator=(MotionTracker&&) noexcept = default;
MotionTracker::~MotionTracker() = default;

std::optional<MotionReport> MotionTracker::feed(const MargSample& sample) {
  State& s = *state_;
  s.heading->feed(sample);
  const std::optional<Attitude> attitude = s.heading->attitude();
  if (const auto rate = s.gate.turn_rate(sample); rate && attitude) s.watch_turn(*rate, *attitude);
  if (const auto acceleration = s.gate.acceleration(sample)) s.wait(s.watch_steps(sample.time, *acceleration, attitude));
  if (const auto field = s.gate.field(sample)) s.field = field->value;
  s.climb.feed(sample, s.steps.walking());
  if (!attitude) return std::nullopt;
  s.remember_heading(*attitude);
  if (s.reported && sample.time <= *s.reported) return std::nullopt;  // out of order: its content is used, its time is past
  // A silence longer than a report may cover is not walking time: begin a new interval after it.
  if (s.reported && sample.time - *s.reported > std::chrono::seconds(60)) s.reported = sample.time - s.report_interval;
  const double silent_s = s.reported ? seconds(sample.time - *s.reported) : 1e9;
  const bool with_step = s.waiting_count > 0 && s.reported && silent_s >= kCatchUpS;
  if (!with_step && s.reported && sample.time - *s.reported < s.report_interval) return std::nullopt;
  return s.report(sample.time, *attitude, with_step);
}

std::optional<Attitude> MotionTracker::attitude() const { return state_->heading->attitude(); }
void MotionTracker::expect(const MagneticField& field) { state_->heading->expect(field); }

WalkState MotionTracker::walk() const {
  const State& s = *state_;
  WalkState walk;
  walk.walking = s.steps.walking();
  walk.confidence = 1.0 / (1.0 + std::exp(-s.steps.gait().log_odds));
  walk.steps = s.step_count;
  walk.last_step = s.last_step;
  walk.step_length_m = s.newest_length_m;
  if (walk.walking) {
    walk.cadence_hz = s.length.cadence_hz;
    walk.speed_mps = walk.cadence_hz * s.newest_length_m;
    walk.speed_sigma_mps = walk.speed_mps * std::hypot(s.length.scale_sigma, s.length_settings.relative_sigma_step);
  }
  walk.carrying = s.direction.carrying;
  walk.climbing = s.lift.riding() ? Climbing::kLift : s.climb.climbing();
  walk.lift = s.lift.ride();
  return walk;
}

void MotionTracker::taught(const FusedPosition& position) {
  const Covariance& c = position.covariance;
  const double sigma_m = std::sqrt(std::max(0.0, 0.5 * (c.xx_m2 + c.yy_m2)));
  state_->length.taught(state_->length_settings, position.place.point, sigma_m);
}

MotionCalibration MotionTracker::calibration() const {
  MotionCalibration known;
  known.sensors = state_->heading->calibration().value_or(SensorCalibration{});
  known.step_scale = state_->length.scale;
  known.step_scale_sigma = state_->length.scale_sigma;
  return known;
}

std::vector<std::string> heading_estimator_names() {
  std::vector<std::string> names;
  for (const HeadingEstimatorRow& row : heading_estimators()) names.emplace_back(row.name);
  return names;
}

}  // namespace wayfuse
