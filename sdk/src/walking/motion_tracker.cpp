#include "wayfuse/sdk/motion_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sdk/src/attitude/catalogue.hpp"
#include "sdk/src/attitude/sample_gate.hpp"
#include "sdk/src/walking/step_detector.hpp"
#include "sdk/src/walking/walking_direction.hpp"

namespace wayfuse {
namespace {

constexpr double kRestAfterS = 1.5;           // without a step and without shaking
constexpr double kRestDeviation = 0.35;       // m/s2, smoothed mean of | |a| - mean |
constexpr double kTurningRadps = 0.35;        // mean over the interval, 20 degrees a second
constexpr double kStepSigma = 0.12;           // of a step's length
constexpr double kStandingSigmaM = 0.1;       // of an interval without steps

}  // namespace

struct MotionTracker::State {
  Duration report_interval;
  std::unique_ptr<HeadingEstimator> heading;
  StepDetector steps;
  SampleGate gate;
  double mean_mps2 = 9.81, deviation_mps2 = 1.0;
  std::optional<PhoneTime> reported, last_step;
  double turned_rad = 0.0;
  std::optional<PhoneTime> turned_until;
  std::optional<Vector3> field;
  std::optional<double> height_m, reported_height_m;

  void watch_turn(const MargSample& sample, const Attitude& attitude);
  void watch_height(const MargSample& sample);
  std::optional<Step> watch_steps(const MargSample& sample);
  MotionReport report(PhoneTime time, const Attitude& attitude, const std::optional<Step>& step);
};

void MotionTracker::State::watch_turn(const MargSample& sample, const Attitude& attitude) {
  if (!sample.turn_rate_radps) return;
  const double dt_s = turned_until ? seconds(sample.time - *turned_until) : 0.0;
  if (dt_s > 0.0 && dt_s < 1.0) turned_rad += rotate(attitude.body_to_enu, attitude.turn_rate_radps).z * dt_s;
  turned_until = sample.time;
}

// International barometric formula about sea level: 8.4 m a hPa is enough for differences.
void MotionTracker::State::watch_height(const MargSample& sample) {
  if (!sample.pressure_hpa || !std::isfinite(*sample.pressure_hpa)) return;
  if (*sample.pressure_hpa < 300.0 || *sample.pressure_hpa > 1100.0) return;
  const double measured_m = 44330.0 * (1.0 - std::pow(*sample.pressure_hpa / 1013.25, 0.1903));
  height_m = height_m ? *height_m + 0.1 * (measured_m - *height_m) : measured_m;
  if (!reported_height_m) reported_height_m = height_m;
}

std::optional<Step> MotionTracker::State::watch_steps(const MargSample& sample) {
  const auto acceleration = gate.acceleration(sample);
  if (!acceleration) return std::nullopt;
  const double length = norm(acceleration->value);
  const double gain = std::min(1.0, acceleration->dt_s / 0.7);
  mean_mps2 += gain * (length - mean_mps2);
  deviation_mps2 += gain * (std::abs(length - mean_mps2) - deviation_mps2);
  return steps.feed(sample.time, length);
}

MotionReport MotionTracker::State::report(PhoneTime time, const Attitude& attitude, const std::optional<Step>& step) {
  MotionReport report;
  report.time = time;
  report.interval = reported ? time - *reported : Duration{0};
  report.heading = facing_of(attitude.body_to_enu);
  report.heading_sigma_rad = std::clamp(attitude.heading_sigma_rad, 0.0, std::numbers::pi);
  report.reference = attitude.reference;
  const double interval_s = seconds(report.interval);
  report.turn_rate_radps = interval_s > 0.0 ? std::clamp(turned_rad / interval_s, -35.0, 35.0) : 0.0;
  report.turning = std::abs(report.turn_rate_radps) > kTurningRadps;
  report.distance_sigma_m = kStandingSigmaM;
  if (step) {
    report.steps = 1;
    report.step_length_m = weinberg_step_length_m(step->swing_mps2);
    report.distance_sigma_m = kStepSigma * report.step_length_m;
  }
  report.at_rest = !step && deviation_mps2 < kRestDeviation && (!last_step || seconds(time - *last_step) > kRestAfterS);
  if (report.at_rest) report.distance_sigma_m = 0.02;
  if (height_m) report.climb_m = *height_m - *reported_height_m;
  if (field) {
    const Vector3 enu = rotate(attitude.body_to_enu, *field);
    report.field_horizontal_ut = std::hypot(enu.x, enu.y);
    report.field_vertical_ut = -enu.z;
  }
  reported = time;
  reported_height_m = height_m;
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
  return MotionTracker(std::move(state));
}

MotionTracker::MotionTracker(std::unique_ptr<State> state) : state_(std::move(state)) {}
MotionTracker::MotionTracker(MotionTracker&&) noexcept = default;
MotionTracker& MotionTracker::operator=(MotionTracker&&) noexcept = default;
MotionTracker::~MotionTracker() = default;

std::optional<MotionReport> MotionTracker::feed(const MargSample& sample) {
  State& s = *state_;
  s.heading->feed(sample);
  s.watch_height(sample);
  const std::optional<Step> step = s.watch_steps(sample);
  if (const auto field = s.gate.field(sample)) s.field = field->value;
  const std::optional<Attitude> attitude = s.heading->attitude();
  if (!attitude) return std::nullopt;
  s.watch_turn(sample, *attitude);
  if (step) s.last_step = sample.time;
  if (s.reported && sample.time <= *s.reported) return std::nullopt;  // out of order: its content is used, its time is past
  // A silence longer than a report may cover is not walking time: begin a new interval after it.
  if (s.reported && sample.time - *s.reported > std::chrono::seconds(60)) s.reported = sample.time - s.report_interval;
  if (!step && s.reported && sample.time - *s.reported < s.report_interval) return std::nullopt;
  return s.report(sample.time, *attitude, step);
}

std::optional<Attitude> MotionTracker::attitude() const { return state_->heading->attitude(); }
void MotionTracker::expect(const MagneticField& field) { state_->heading->expect(field); }

std::vector<std::string> heading_estimator_names() {
  std::vector<std::string> names;
  for (const HeadingEstimatorRow& row : heading_estimators()) names.emplace_back(row.name);
  return names;
}

}  // namespace wayfuse
