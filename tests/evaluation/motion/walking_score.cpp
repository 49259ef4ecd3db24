#include "tests/evaluation/motion/walking_score.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sdk/src/attitude/rotation.hpp"
#include "sdk/src/walking/step_detector.hpp"
#include "sdk/src/walking/walk_detector.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

namespace wayfuse {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double at = p * static_cast<double>(values.size() - 1);
  const std::size_t low = static_cast<std::size_t>(at), high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

std::vector<StepCount> count_steps(const std::vector<MargSample>& samples) {
  WalkDetector walk;
  StepDetector peaks;
  StepCount walked{"wayfuse", 0}, peaked{"peaks_p2", 0};
  std::optional<PhoneTime> last;
  for (const MargSample& sample : samples) {
    if (!sample.acceleration_mps2 || !finite(*sample.acceleration_mps2) || (last && sample.time <= *last)) continue;
    last = sample.time;
    walked.steps += walk.feed(sample.time, *sample.acceleration_mps2).count;
    peaked.steps += peaks.feed(sample.time, norm(*sample.acceleration_mps2)).has_value();
  }
  return {walked, peaked};
}

ReckonedWalk reckon(const RecordedWalk& walk, const std::string& heading_estimator) {
  MotionTrackerSettings settings;
  settings.heading_estimator = heading_estimator;
  MotionTracker tracker = std::move(MotionTracker::create(settings)).value();
  ReckonedWalk result;
  Stretch now;
  std::size_t next = 0;  // way point ahead
  const auto pass = [&](std::size_t reached) {
    if (reached > 0) {
      const BuildingPoint a = walk.way_points[reached - 1].point, b = walk.way_points[reached].point;
      now.true_m = distance_m(a, b);
      now.true_rad = std::atan2(b.y_m - a.y_m, b.x_m - a.x_m);
      result.true_m += now.true_m;
      result.stretches.push_back(now);
    }
    now = {};
  };
  for (const MargSample& sample : walk.motion) {
    for (; next < walk.way_points.size() && walk.way_points[next].time <= sample.time; ++next) pass(next);
    const auto report = tracker.feed(sample);
    if (!report || next == 0 || next >= walk.way_points.size()) continue;
    result.reckoned_m += report->distance_m();
    result.steps += report->steps;
    now.dx_m += report->distance_m() * report->heading.cos();
    now.dy_m += report->distance_m() * report->heading.sin();
  }
  for (; next < walk.way_points.size(); ++next) pass(next);
  return result;
}

DirectionErrors direction_errors(const std::vector<ReckonedWalk>& walks, double least_m) {
  DirectionErrors errors;
  for (const ReckonedWalk& walk : walks) {
    std::vector<double> of_walk;
    double cosines = 0.0, sines = 0.0;
    for (const Stretch& stretch : walk.stretches) {
      if (stretch.true_m < least_m || std::hypot(stretch.dx_m, stretch.dy_m) < 0.5) continue;
      of_walk.push_back(wrap_angle_rad(std::atan2(stretch.dy_m, stretch.dx_m) - stretch.true_rad));
      cosines += std::cos(of_walk.back());
      sines += std::sin(of_walk.back());
    }
    const double mean = std::atan2(sines, cosines);
    for (const double error : of_walk) {
      errors.absolute_deg.push_back(std::abs(error) / kDegree);
      if (of_walk.size() > 1) errors.relative_deg.push_back(std::abs(wrap_angle_rad(error - mean)) / kDegree);
    }
  }
  return errors;
}

}  // namespace wayfuse
