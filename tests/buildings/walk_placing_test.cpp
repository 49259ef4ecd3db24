#include "server/buildings/walk_placing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace wayfuse {
namespace {

PhoneTime at(double time_s) { return PhoneTime{from_seconds(time_s)}; }

RssScan scan_at(double time_s, std::uint64_t bssid) {
  return {at(time_s), {{Bssid{bssid}, -50.0, Duration{0}, 2412, {}, {}}}};
}

/// A quarter circle of 10 m about (0, 0) from (10, 0) to (0, 10) in 10 s, marked at both ends only. The phone's compass is off
/// by `turned_rad` and its steps by `stride`; a scan every second, each of another transmitter.
SurveyWalk quarter_circle(double turned_rad, double stride) {
  SurveyWalk walk;
  walk.walk = "bend";
  walk.marks = {{at(0), {{10, 0}, {0}}, 0.2}, {at(10), {{0, 10}, {0}}, 0.2}};
  for (int i = 1; i <= 100; ++i) {
    const double a = (i - 0.5) / 100.0 * std::numbers::pi / 2;
    MotionReport step;
    step.time = at(0.1 * i);
    step.interval = std::chrono::milliseconds(100);
    step.heading = Heading::from_radians(a + std::numbers::pi / 2 + turned_rad);
    step.steps = 1;
    step.step_length_m = stride * 10.0 * std::numbers::pi / 200.0;
    walk.motion.push_back(step);
  }
  for (int i = 1; i < 10; ++i) walk.scans.push_back(scan_at(i, 1000u + static_cast<unsigned>(i)));
  return walk;
}

TEST(WalkPlacing, FollowsTheBendWhateverTheCompassAndTheStride) {
  for (const double turned : {0.0, 1.2, -2.9}) {
    for (const double stride : {0.7, 1.0, 1.5}) {
      const auto points = place_walk(std::vector{quarter_circle(turned, stride)}, {});
      ASSERT_EQ(points.size(), 9u);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double a = static_cast<double>(i + 1) / 10.0 * std::numbers::pi / 2;
        EXPECT_NEAR(points[i].place.point.x_m, 10.0 * std::cos(a), 0.02) << turned << " " << stride;
        EXPECT_NEAR(points[i].place.point.y_m, 10.0 * std::sin(a), 0.02);
        EXPECT_GT(points[i].sigma_m, 0.2) << "less sure than at a mark";
      }
    }
  }
}

TEST(WalkPlacing, StandsWhereTheWalkerStoodAndGoesStraightWithoutShape) {
  // Five seconds of standing, then 10 m in five seconds, without a word about direction (stride 0.01: under 1 m felt).
  SurveyWalk walk;
  walk.walk = "stop";
  walk.marks = {{at(0), {{0, 0}, {0}}, 0.0}, {at(10), {{10, 0}, {0}}, 0.0}};
  for (int i = 6; i <= 10; ++i) {
    MotionReport step;
    step.time = at(i);
    step.interval = std::chrono::seconds(1);
    step.steps = 1;
    step.step_length_m = 0.01;
    walk.motion.push_back(step);
  }
  walk.scans = {scan_at(2, 1), scan_at(4.9, 2), scan_at(7.5, 3)};
  const auto points = place_walk(std::vector{walk}, {});
  ASSERT_EQ(points.size(), 3u);
  EXPECT_NEAR(points[0].place.point.x_m, 0.0, 1e-9);
  EXPECT_NEAR(points[1].place.point.x_m, 0.0, 1e-9);
  EXPECT_NEAR(points[2].place.point.x_m, 5.0, 1e-6);  // 2.5 of 5 steps
}

TEST(WalkPlacing, LeavesOutWhatHasNoPlaceAndKeepsOffTheWalls) {
  SurveyWalk walk = quarter_circle(0.0, 1.0);
  walk.scans.insert(walk.scans.begin(), scan_at(-1, 7));
  walk.scans.push_back(scan_at(11, 8));
  // The corridor is the band y >= x + 1 .. : the point at 45 degrees lies off it and is moved onto its edge.
  Floor floor;
  floor.ordinal = {0};
  floor.walkable = {{{{{0, 7.5}, {12, 7.5}, {12, 12}, {0, 12}}}}, {{{{7.5, 0}, {12, 0}, {12, 7.4}, {7.5, 7.4}}}}};
  const auto points = place_walk(std::vector{walk}, std::vector{floor});
  ASSERT_EQ(points.size(), 9u);
  EXPECT_NEAR(points[4].place.point.x_m, 7.5, 0.02);  // 7.07, 7.07 is 0.43 m off either area
  for (const ReferencePoint& point : points) {
    EXPECT_TRUE(point.place.point.x_m > 7.49 || point.place.point.y_m > 7.49) << point.place.point.x_m << " " << point.place.point.y_m;
  }
}

TEST(WalkPlacing, PartsInTheirOrderAreOneWalk) {
  const SurveyWalk whole = quarter_circle(0.5, 1.0);
  SurveyWalk first = whole, second = whole;
  second.part = 1;
  first.marks.resize(1), second.marks.erase(second.marks.begin());
  first.motion.resize(40), second.motion.erase(second.motion.begin(), second.motion.begin() + 40);
  first.scans.resize(4), second.scans.erase(second.scans.begin(), second.scans.begin() + 4);
  EXPECT_EQ(place_walk(std::vector{first, second}, {}), place_walk(std::vector{whole}, {}));
}

TEST(WalkPlacing, NothingBetweenMarksOfTwoFloors) {
  SurveyWalk walk = quarter_circle(0.0, 1.0);
  walk.marks[1].place.floor = {1};
  EXPECT_TRUE(place_walk(std::vector{walk}, {}).empty());
  EXPECT_TRUE(place_walk({}, {}).empty());
}

}  // namespace
}  // namespace wayfuse
