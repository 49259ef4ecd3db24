#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "wayfuse/proto/random.hpp"
#include "wayfuse/sdk/position_now.hpp"

namespace wayfuse {
namespace {

using namespace std::chrono_literals;

PhoneTime at_s(double time_s) { return PhoneTime{from_seconds(time_s)}; }

MotionReport walking(double time_s, double heading_rad = 0.0, double speed = 1.4) {
  MotionReport report;
  report.time = at_s(time_s);
  report.interval = 500ms;
  report.heading = Heading::from_radians(heading_rad);
  report.heading_sigma_rad = 0.1;
  report.reference = HeadingReference::kTrue;
  report.speed_mps = speed;
  report.distance_sigma_m = 0.05;
  return report;
}

FusedPosition fused(double valid_at_s, double x, double y, double heading_rad = 0.0) {
  FusedPosition position;
  position.valid_at = at_s(valid_at_s);
  position.place = {{x, y}, {0}};
  position.radius68_m = 2;
  position.radius95_m = 4;
  position.heading = Heading::from_radians(heading_rad);
  position.heading_sigma_rad = 0.1;
  position.speed_mps = 1.4;
  return position;
}

TEST(PositionNow, KnowsNothingBeforeTheServerSpoke) {
  PositionNow now;
  now.moved(walking(1));
  EXPECT_FALSE(now.at(at_s(1)));
}

//  fused at 10 s in (0, 0), valid two seconds ago when it arrives at 12 s; 1.4 m/s east since
TEST(PositionNow, CarriesAnOldWordForwardByTheMotionSince) {
  PositionNow now;
  for (double t = 9; t <= 12; t += 0.5) now.moved(walking(t));
  now.fused(fused(10, 0, 0), at_s(12));
  const auto live = now.at(at_s(12));
  ASSERT_TRUE(live);
  EXPECT_NEAR(live->place.point.x_m, 2 * 1.4, 1e-9);
  EXPECT_NEAR(live->place.point.y_m, 0, 1e-9);
  EXPECT_EQ(live->since_fused, 2s);
  EXPECT_GT(live->radius68_m, 2);
  EXPECT_LT(live->radius68_m, 2.6);
}

TEST(PositionNow, CountsOnlyThePartOfAReportAfterTheWord) {
  PositionNow now;
  now.fused(fused(10.25, 0, 0), at_s(10.25));
  now.moved(walking(10.5));  // covers 10.0 .. 10.5, half of it after the word
  now.at(at_s(10.5));
  EXPECT_NEAR(now.at(at_s(14.5))->place.point.x_m, 0.25 * 1.4 + 1.4, 1e-3);  // and a second of going on
}

TEST(PositionNow, MovesSmoothlyAtSixtyHertzWhateverArrives) {
  // A walker in a circle; the server's words come late, off by metres, in bursts and with gaps. From one frame to the next the
  // dot never moves further than a running walker plus the fastest part of a correction: |offset| / rejoin_s x 1/60 s.
  Random random(7);
  PositionNow now;
  double worst = 0;
  double error = 0;
  int frames = 0;
  std::optional<BuildingPoint> before;
  double next_word = 1;
  double largest_offset = 0;
  const auto truth = [](double t) { return BuildingPoint{20 * std::sin(0.07 * t), 20 - 20 * std::cos(0.07 * t)}; };
  for (int frame = 1; frame < 60 * 120; ++frame) {
    const double t = frame / 60.0;
    if (frame % 30 == 0) now.moved(walking(t, 0.07 * t));
    const bool gap = t > 40 && t < 70;
    if (t >= next_word && !gap) {
      next_word = t + 0.2 + 2 * random.uniform();
      const double valid = t - 0.8 * random.uniform();
      const BuildingPoint there = truth(valid);
      const double off = 3 * random.normal();
      largest_offset = std::max(largest_offset, std::abs(off));
      now.fused(fused(valid, there.x_m + off, there.y_m + random.normal(), 0.07 * valid), at_s(t));
    }
    const auto live = now.at(at_s(t));
    if (!live) continue;
    if (before) worst = std::max(worst, distance_m(*before, live->place.point));
    before = live->place.point;
    error += distance_m(live->place.point, truth(t));
    ++frames;
  }
  EXPECT_LT(worst, 1.4 / 60 * 1.5 + 2 * largest_offset / 0.5 / 60);
  EXPECT_LT(error / frames, 4);
}

TEST(PositionNow, StepsAsTheyComeDoNotMakeTheDotSurge) {
  // A step of 0.7 m every 0.55 s, reported at once; half a second of silence makes a report without a step, so that a step's own
  // interval is 0.05 s. The walker goes 1.27 m/s, and so must the dot, frame by frame.
  PositionNow now;
  now.fused(fused(0, 0, 0), at_s(0));
  double reported = 0, next_step = 0.55, fastest = 0, slowest = 10;
  std::optional<BuildingPoint> before;
  for (int frame = 1; frame < 60 * 30; ++frame) {
    const double t = frame / 60.0;
    const bool step = t >= next_step;
    if (step || t - reported >= 0.5) {
      MotionReport report = walking(t);
      report.interval = from_seconds(t - reported);
      report.speed_mps.reset();
      report.steps = step ? 1 : 0;
      report.step_length_m = 0.7;
      now.moved(report);
      reported = t;
      if (step) next_step += 0.55;
    }
    const auto live = now.at(at_s(t));
    const double speed = before ? distance_m(*before, live->place.point) * 60 : 1.27;
    before = live->place.point;
    if (t < 5) continue;
    fastest = std::max(fastest, speed);
    slowest = std::min(slowest, speed);
    EXPECT_NEAR(live->place.point.x_m, 0.7 / 0.55 * t, 1.0);
  }
  EXPECT_LT(fastest, 1.9);  // half as fast again
  EXPECT_GT(slowest, 0.5);
}

TEST(PositionNow, ReckonsThroughAGapWithHonestlyGrowingRadii) {
  PositionNow now;
  now.fused(fused(0, 0, 0), at_s(0));
  double previous = 0;
  for (double t = 0.5; t <= 30; t += 0.5) {
    now.moved(walking(t));
    const auto live = now.at(at_s(t));
    EXPECT_GE(live->radius68_m, previous - 1e-9);
    previous = live->radius68_m;
  }
  const auto live = now.at(at_s(30));
  EXPECT_NEAR(live->place.point.x_m, 42, 0.1);
  // 42 m with a heading known to 0.1 rad: 4.2 m sideways, 0.05 m x sqrt(60) along.
  EXPECT_NEAR(live->radius68_m, std::sqrt(4 + 1.5096 * 1.5096 * (4.2 * 4.2 + 60 * 0.0025)), 0.05);
}

TEST(PositionNow, StopsAndDoubtsWhenTheSensorsFallSilent) {
  PositionNow now;
  now.fused(fused(0, 0, 0), at_s(0));
  now.moved(walking(0.5));
  now.at(at_s(0.5));
  const auto soon = now.at(at_s(1.6));
  const auto later = now.at(at_s(20));
  EXPECT_NEAR(later->place.point.x_m, soon->place.point.x_m, 0.1);
  EXPECT_DOUBLE_EQ(later->speed_mps, 0);
  EXPECT_GT(later->radius68_m, 10);
}

TEST(PositionNow, LearnsHowFarThePhonesHeadingIsOff) {
  PositionNow now;  // the phone says east, the server sees the walker go north
  for (double t = 0.5; t <= 20; t += 0.5) {
    now.moved(walking(t));
    now.fused(fused(t, 0, 1.4 * t, std::numbers::pi / 2), at_s(t));
  }
  for (double t = 20.5; t <= 25; t += 0.5) now.moved(walking(t));
  const auto live = now.at(at_s(25));
  EXPECT_NEAR(live->place.point.x_m, 0, 0.2);
  EXPECT_NEAR(live->place.point.y_m, 35, 0.3);
}

TEST(PositionNow, TurnsCompassHeadingsIntoTheBuildingsFrame) {
  // The building's y axis points east; magnetic north lies 10 degrees east of true north. The phone walks magnetic north.
  PositionNow now;
  Welcome welcome;
  welcome.georeference = Georeference{{47, 8}, std::numbers::pi / 2};
  welcome.magnetic_field.declination_rad = 10 * std::numbers::pi / 180;
  now.welcomed(welcome);
  FusedPosition start = fused(0, 0, 0);
  start.heading_sigma_rad = 3;  // the server does not know the heading
  now.fused(start, at_s(0));
  for (double t = 0.5; t <= 10; t += 0.5) {
    MotionReport report = walking(t, std::numbers::pi / 2);  // heading: ccw from (magnetic) east
    report.reference = HeadingReference::kMagnetic;
    now.moved(report);
    now.at(at_s(t));
  }
  const BuildingPoint point = now.at(at_s(10))->place.point;
  // True azimuth 10 degrees; local y = east, local x = south: so x = -14 cos 10, y = 14 sin 10.
  EXPECT_NEAR(point.x_m, -14 * std::cos(10 * std::numbers::pi / 180), 0.05);
  EXPECT_NEAR(point.y_m, 14 * std::sin(10 * std::numbers::pi / 180), 0.05);
  EXPECT_TRUE(now.at(at_s(10))->geo);
}

TEST(PositionNow, PassesOverWordsOutOfTimeAndBoundsWhatItKeeps) {
  PositionNowSettings settings;
  settings.reports_most = 50;
  PositionNow now(settings);
  now.fused(fused(10, 5, 5), at_s(10));
  now.fused(fused(9, 50, 50), at_s(10.1));
  now.fused(fused(500, 50, 50), at_s(10.2));
  EXPECT_NEAR(now.at(at_s(10.2))->place.point.y_m, 5, 1e-6);
  for (double t = 10.5; t < 3000; t += 0.5) now.moved(walking(t, 0, 0));
  EXPECT_TRUE(std::isfinite(now.at(at_s(3000))->radius95_m));
}

}  // namespace
}  // namespace wayfuse
