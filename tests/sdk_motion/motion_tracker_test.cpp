#include "wayfuse/sdk/motion_tracker.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "sdk/src/walking/walking_direction.hpp"
#include "tests/sdk_motion/still_phone.hpp"

namespace wayfuse {
namespace {

MotionTracker tracker() { return std::move(MotionTracker::create({})).value(); }

// A walker who bobs with 2 steps a second: vertical acceleration of amplitude 4 m/s2 on top of gravity.
MargSample walking(double time_s, Quaternion body_to_enu, double steps_per_s = 2.0) {
  MargSample sample = sense(time_s, body_to_enu);
  const double bob = 4.0 * std::sin(2 * std::numbers::pi * steps_per_s * time_s);
  sample.acceleration_mps2 = unrotate(body_to_enu, {0, 0, 9.81 + bob});
  return sample;
}

struct Total {
  int steps = 0;
  double metres = 0.0;
  double covered_s = 0.0;
  MotionReport last;
};

Total walk(MotionTracker& phone, double from_s, double until_s, Quaternion body_to_enu, double rate_hz = 50.0) {
  Total total;
  for (double t = from_s; t < until_s; t += 1.0 / rate_hz) {
    if (const auto report = phone.feed(walking(t, body_to_enu))) {
      total.steps += report->steps;
      total.metres += report->distance_m();
      total.covered_s += seconds(report->interval);
      total.last = *report;
    }
  }
  return total;
}

TEST(MotionTracker, CountsTheStepsOfAWalk) {
  for (const double rate_hz : {25.0, 50.0, 100.0, 400.0}) {
    MotionTracker phone = tracker();
    const Total total = walk(phone, 0.0, 30.0, held(90), rate_hz);
    EXPECT_NEAR(total.steps, 60, 2) << rate_hz << " Hz";
    EXPECT_NEAR(total.metres / total.steps, 0.7, 0.2);
    EXPECT_NEAR(total.covered_s, 30.0, 0.7);  // the intervals join without hole or overlap
  }
}

// Walking is recognised after two seconds or so; the steps before it are not lost, and no report tells of a sprint.
TEST(MotionTracker, StepsRecognisedLateFollowOneByOne) {
  MotionTracker phone = tracker();
  for (int i = 0; i < 250; ++i) phone.feed(sense(i * 0.02, held(0)));
  int steps = 0;
  double fastest_mps = 0.0;
  for (double t = 5.0; t < 15.0; t += 0.02) {
    if (const auto report = phone.feed(walking(t, held(0)))) {
      EXPECT_LE(report->steps, 1);
      steps += report->steps;
      if (report->steps > 0) fastest_mps = std::max(fastest_mps, report->distance_m() / seconds(report->interval));
    }
  }
  EXPECT_NEAR(steps, 20, 2);
  EXPECT_LT(fastest_mps, 13.0);
}

TEST(MotionTracker, ReportsTheDirectionOfAPhoneHeldFlatTiltedAndUpright) {
  for (const double pitch : {0.0, 30.0, 60.0, 89.9, 100.0}) {
    MotionTracker phone = tracker();
    const Total total = walk(phone, 0.0, 5.0, held(200, pitch));
    EXPECT_NEAR(total.last.heading.azimuth_rad() / kDegree, 200.0, 1.0) << pitch;
  }
}

TEST(MotionTracker, RestsWhenThePhoneLiesStill) {
  MotionTracker phone = tracker();
  std::optional<MotionReport> last;
  for (int i = 0; i < 500; ++i) {
    if (auto report = phone.feed(sense(i * 0.02, held(0)))) last = report;
  }
  ASSERT_TRUE(last);
  EXPECT_TRUE(last->at_rest);
  EXPECT_EQ(last->distance_m(), 0.0);
  EXPECT_EQ(last->steps, 0);
}

TEST(MotionTracker, SpeaksAtLeastEveryInterval) {
  MotionTracker phone = tracker();
  PhoneTime last{};
  for (int i = 0; i < 500; ++i) {
    if (const auto report = phone.feed(sense(i * 0.02, held(0)))) {
      EXPECT_TRUE(last == PhoneTime{} || report->time - last <= std::chrono::milliseconds(500));
      last = report->time;
    }
  }
  EXPECT_GE(last, PhoneTime{std::chrono::milliseconds(9400)});
}

TEST(MotionTracker, TellsTurns) {
  MotionTracker phone = tracker();
  const double rate = 90 * kDegree;
  std::optional<MotionReport> last;
  for (int i = 0; i < 100; ++i) {
    if (auto report = phone.feed(sense(i * 0.02, about_up(rate * i * 0.02), {0, 0, rate}))) last = report;
  }
  ASSERT_TRUE(last);
  EXPECT_TRUE(last->turning);
  EXPECT_NEAR(last->turn_rate_radps, rate, 0.05);
}

TEST(MotionTracker, TellsHowFarItClimbed) {
  MotionTracker phone = tracker();
  double climbed = 0.0;
  for (int i = 0; i < 1000; ++i) {
    MargSample sample = sense(i * 0.02, held(0));
    sample.pressure_hpa = 1000.0 - (i > 200 && i < 600 ? (i - 200) * 0.001 : i >= 600 ? 0.4 : 0.0);
    if (const auto report = phone.feed(sample)) climbed += report->climb_m.value_or(0.0);
  }
  EXPECT_NEAR(climbed, 0.4 * 8.4, 0.15);  // 8.4 m a hPa
}

TEST(MotionTracker, LivesThroughBrokenSamples) {
  MotionTracker phone = tracker();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  int steps = 0;
  for (int i = 0; i < 1500; ++i) {
    MargSample sample = walking(i * 0.02, held(90));
    if (i % 7 == 0) sample.acceleration_mps2 = Vector3{nan, nan, nan};
    if (i % 11 == 0) sample.turn_rate_radps = Vector3{nan, 0, 0};
    if (i % 13 == 0) sample.field_ut = Vector3{0, nan, 0};
    for (int twice = 0; twice < 2; ++twice) {
      if (const auto report = phone.feed(sample)) {
        steps += report->steps;
        ASSERT_TRUE(std::isfinite(report->heading.radians()));
        ASSERT_TRUE(std::isfinite(report->distance_sigma_m));
        ASSERT_GE(report->interval, Duration{0});
      }
    }
  }
  EXPECT_NEAR(steps, 60, 2);
}

TEST(MotionTracker, AfterALongSilenceItsReportsStayWithinTheLimits) {
  MotionTracker phone = tracker();
  walk(phone, 0.0, 5.0, held(0));
  for (double t = 7200.0; t < 7210.0; t += 0.02) {
    if (const auto report = phone.feed(walking(t, held(0)))) {
      EXPECT_LE(report->interval, std::chrono::seconds(60));
    }
  }
}

TEST(MotionTracker, RefusesSettingsThatMeanNothing) {
  MotionTrackerSettings settings;
  settings.heading_estimator = "none";
  EXPECT_EQ(MotionTracker::create(settings).fault().code, FaultCode::kUnknownName);
  settings = {};
  settings.report_interval = Duration{0};
  EXPECT_EQ(MotionTracker::create(settings).fault().field, "report_interval");
  settings = {};
  settings.calibration = MotionCalibration{};
  settings.calibration->step_scale = 3.0;
  EXPECT_EQ(MotionTracker::create(settings).fault().field, "calibration.step_scale");
  for (const std::string& name : heading_estimator_names()) {
    settings = {};
    settings.heading_estimator = name;
    EXPECT_TRUE(MotionTracker::create(settings));
  }
}

// Fused positions 10 % further apart than the reckoned ones, every three seconds along a straight walk.
TEST(MotionTracker, FusedPositionsTeachTheLengthOfThisWalkersSteps) {
  MotionTracker phone = tracker();
  double reckoned_m = 0.0, before_m = 0.0, after_m = 0.0;
  for (int k = 0; k < 60; ++k) {
    const Total total = walk(phone, k * 3.0, (k + 1) * 3.0, held(90));
    // What the unscaled model would have said: the truth is 1.1 times that.
    reckoned_m += total.metres / phone.calibration().step_scale;
    if (k == 3) before_m = total.metres / total.steps;
    after_m = total.metres / std::max(1, total.steps);
    FusedPosition fused;
    fused.place.point = {1.1 * reckoned_m, 0.0};
    fused.covariance = {1.0, 0.0, 1.0};
    phone.taught(fused);
  }
  EXPECT_NEAR(after_m / before_m, 1.1, 0.04);
  EXPECT_LT(phone.calibration().step_scale_sigma, 0.06);

  MotionTrackerSettings settings;
  settings.calibration = phone.calibration();
  MotionTracker next = std::move(MotionTracker::create(settings)).value();
  const Total total = walk(next, 0.0, 10.0, held(90));
  EXPECT_NEAR(total.metres / total.steps / before_m, 1.1, 0.05);
}

TEST(MotionTracker, KnowsTheWalk) {
  MotionTracker phone = tracker();
  EXPECT_FALSE(phone.walk().walking);
  walk(phone, 0.0, 20.0, held(90, 30));
  const WalkState state = phone.walk();
  EXPECT_TRUE(state.walking);
  EXPECT_GT(state.confidence, 0.7);
  EXPECT_NEAR(state.cadence_hz, 2.0, 0.05);
  EXPECT_NEAR(state.speed_mps, state.cadence_hz * state.step_length_m, 1e-9);
  EXPECT_GT(state.speed_sigma_mps, 0.0);
  EXPECT_EQ(state.carrying, Carrying::kHeld);
  EXPECT_NEAR(static_cast<double>(state.steps), 40, 2);
}

TEST(MotionTracker, ALiftIsNoStaircase) {
  for (const bool on_foot : {false, true}) {
    MotionTracker phone = tracker();
    for (int i = 0; i < 1500; ++i) {
      MargSample sample = on_foot ? walking(i * 0.02, held(0)) : sense(i * 0.02, held(0));
      sample.pressure_hpa = 1000.0 - std::max(0, i - 700) * 0.02 * 0.05;  // 0.4 m/s up
      phone.feed(sample);
    }
    EXPECT_EQ(phone.walk().climbing, on_foot ? Climbing::kStairs : Climbing::kLift);
  }
}

// A phone in a front pocket, upside down and turned sideways, on a walk to the north: its owner's gait tells the way.
TEST(MotionTracker, InAPocketTheGaitTellsTheDirection) {
  MotionTracker phone = tracker();
  std::optional<MotionReport> last;
  for (int i = 0; i < 1500; ++i) {
    const double t = i * 0.02, phase = 2 * std::numbers::pi * 2.0 * t;
    const Quaternion attitude = held(250, -70 + 25 * std::sin(phase / 2), 30);
    const Quaternion later = held(250, -70 + 25 * std::sin((phase + 2 * std::numbers::pi * 2.0 * 0.001) / 2), 30);
    const Quaternion d = conjugate(attitude) * later;
    MargSample sample = sense(t, attitude, Vector3{d.x, d.y, d.z} * (2.0 / 0.001));
    // Inverted pendulum: forward acceleration leads the vertical one by a quarter of a step.
    sample.acceleration_mps2 = unrotate(attitude, {0.0, 1.5 * std::cos(phase), 9.81 + 4.0 * std::sin(phase)});
    if (const auto report = phone.feed(sample)) last = report;
  }
  ASSERT_TRUE(last);
  EXPECT_EQ(phone.walk().carrying, Carrying::kPocket);
  EXPECT_LT(std::abs(last->heading.minus(Heading::from_azimuth(0.0))), 15 * kDegree);
  EXPECT_GT(last->heading_sigma_rad, 0.4);
}

}  // namespace
}  // namespace wayfuse
