#include "server/pipeline/tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/locating/plan.hpp"

namespace wayfuse {
namespace {

constexpr double kPi = std::numbers::pi;

Plan hall() {
  return Plan({"A....B....C",
               "...........",
               "...........",
               "D....E....F"}, 4.0);
}

std::shared_ptr<Site> hall_site() {
  auto site = std::make_shared<Site>();
  site->building = BuildingId{7};
  site->survey = hall().survey();
  site->radio_map_version = 3;
  return site;
}

std::shared_ptr<const TrackerFactory> pipeline(const std::string& name, std::shared_ptr<const Site> site) {
  const auto spec = preset(name);
  EXPECT_TRUE(spec);
  auto assembled = assemble(*spec, std::move(site));
  EXPECT_TRUE(assembled);
  return *assembled;
}

PhoneTime at(double time_s) { return PhoneTime{from_seconds(time_s)}; }

MotionReport step(double time_s, double heading_rad, double length_m = 0.7) {
  MotionReport motion;
  motion.time = at(time_s);
  motion.interval = from_seconds(0.5);
  motion.heading = Heading::from_radians(heading_rad);
  motion.heading_sigma_rad = 0.05;
  motion.steps = 1;
  motion.step_length_m = length_m;
  motion.distance_sigma_m = 0.1;
  return motion;
}

// Walks east along y = 6 from x = 2, a step every half second and a scan every two, and returns the mean error of the end half.
double walk_error_m(Tracker& tracker, double reported_turn_rad = 0.0, HeadingReference reference = HeadingReference::kTrue) {
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < 48; ++i) {
    const double time_s = 0.5 * (i + 1);
    const BuildingPoint truth{2.0 + 0.7 * (i + 1), 6.0};
    MotionReport motion = step(time_s, reported_turn_rad);
    motion.reference = reference;
    tracker.feed(motion);
    if (i % 4 == 3) tracker.feed(hall().scan_at(truth, at(time_s)));
    const auto position = tracker.position(at(time_s));
    if (i < 24 || !position) continue;
    sum += distance_m(position->place.point, truth);
    ++count;
  }
  return count ? sum / count : INFINITY;
}

TEST(Tracker, P1FollowsAWalk) {
  const auto factory = pipeline("p1", hall_site());
  const auto tracker = factory->make_tracker(Random(1));
  EXPECT_LT(walk_error_m(*tracker), 1.5);
  const auto position = tracker->position(at(24.0));
  ASSERT_TRUE(position);
  EXPECT_EQ(position->building, BuildingId{7});
  EXPECT_EQ(position->radio_map_version, 3u);
  EXPECT_GT(position->radius68_m, 0.0);
  EXPECT_GE(position->radius95_m, position->radius68_m);
  EXPECT_GT(position->covariance.xx_m2, 0.0);
  ASSERT_EQ(position->floors.size(), 1u);
  EXPECT_EQ(position->floors[0].probability, 1.0);
  EXPECT_EQ(position->from.transmitters_used, 6);
  EXPECT_EQ(position->integrity, Integrity::kOk);
}

TEST(Tracker, AlignsAHeadingOfUnknownOrigin) {
  const auto factory = pipeline("p1", hall_site());
  const auto tracker = factory->make_tracker(Random(1));
  EXPECT_LT(walk_error_m(*tracker, 2.0, HeadingReference::kArbitrary), 3.0);
  EXPECT_NEAR(tracker->position(at(24.0))->heading.radians(), 0.0, 0.5);
}

TEST(Tracker, TurnsCompassHeadingsIntoTheFrame) {
  // The frame's y axis points to azimuth 30 degrees, the compass 10 degrees too far east (declination +10): the local x axis
  // lies at azimuth 120, which this compass calls 110: a heading of 90 - 110 = -20 degrees.
  auto site = hall_site();
  site->georeference = Georeference{{48.0, 11.0}, kPi / 6};
  site->magnetic_field.declination_rad = kPi / 18;
  const auto factory = pipeline("dead-reckoning", site);
  const auto tracker = factory->make_tracker(Random(1), KnownStart{{{0.0, 0.0}, FloorOrdinal{0}}, 0.5, {}});
  MotionReport motion = step(0.5, -kPi / 9, 1.0);
  motion.reference = HeadingReference::kMagnetic;
  tracker->feed(motion);
  const auto position = tracker->position(at(0.5));
  ASSERT_TRUE(position);
  EXPECT_NEAR(position->place.point.x_m, 1.0, 1e-9);
  EXPECT_NEAR(position->place.point.y_m, 0.0, 1e-9);
}

TEST(Tracker, AppliesAReadingWhereItWasHeard) {
  // Heard two seconds (2.8 m) ago: the newest fix must be carried forward by what was walked since.
  const auto factory = pipeline("nn", hall_site());
  const auto tracker = factory->make_tracker(Random(1));
  for (int i = 0; i < 8; ++i) tracker->feed(step(0.5 * (i + 1), 0.0));
  RssScan scan = hall().scan_at({8.0, 4.0}, at(4.0));
  for (auto& reading : scan.readings) reading.age = std::chrono::seconds(2);
  tracker->feed(scan);
  EXPECT_NEAR(tracker->position(at(4.0))->place.point.x_m, 8.0 + 2.8, 1e-6);
}

TEST(Tracker, HearsACachedScanOnce) {
  const auto factory = pipeline("nn", hall_site());
  const auto tracker = factory->make_tracker(Random(1));
  tracker->feed(hall().scan_at({8.0, 4.0}, at(1.0)));
  RssScan repeat = hall().scan_at({20.0, 4.0}, at(3.0));
  for (auto& reading : repeat.readings) reading.age = std::chrono::seconds(2);  // the same moment: a cache
  tracker->feed(repeat);
  EXPECT_NEAR(tracker->position(at(3.0))->place.point.x_m, 8.0, 1e-6);
}

TEST(Tracker, SaysWhyThereIsNoFix) {
  const auto known = pipeline("p1", hall_site());
  const auto tracker = known->make_tracker(Random(1));
  EXPECT_FALSE(tracker->position(at(0.0)));
  EXPECT_EQ(tracker->why_no_fix().code, FaultCode::kNotFound);
  tracker->feed(RssScan{at(1.0), {{Bssid{0xffff}, -50.0, {}, 0, {}, {}}}});
  EXPECT_FALSE(tracker->position(at(1.0)));
  EXPECT_EQ(tracker->why_no_fix().code, FaultCode::kNoKnownAccessPoint);
  const auto empty = pipeline("p1", std::make_shared<Site>());
  EXPECT_EQ(empty->make_tracker(Random(1))->why_no_fix().code, FaultCode::kEmptyRadioMap);
  const auto reckoning = pipeline("dead-reckoning", hall_site());
  EXPECT_EQ(reckoning->make_tracker(Random(1))->why_no_fix().code, FaultCode::kNotFound);
}

TEST(Tracker, DoesNotMoveWhenTimeDoesNot) {
  const auto factory = pipeline("dead-reckoning", hall_site());
  const auto tracker = factory->make_tracker(Random(1), KnownStart{{{0.0, 0.0}, FloorOrdinal{0}}, 0.5, {}});
  tracker->feed(step(1.0, 0.0));
  const auto before = tracker->position(at(1.0));
  tracker->feed(step(1.0, 0.0));
  tracker->feed(step(0.5, 0.0));
  EXPECT_EQ(tracker->position(at(1.0)), before);
}

TEST(Tracker, IsLessSureAfterAMinuteWithoutReports) {
  const auto factory = pipeline("dead-reckoning", hall_site());
  const auto tracker = factory->make_tracker(Random(1), KnownStart{{{0.0, 0.0}, FloorOrdinal{0}}, 0.5, {}});
  tracker->feed(step(1.0, 0.0));
  const double before_m = tracker->position(at(1.0))->radius68_m;
  tracker->feed(step(61.0, 0.0));
  EXPECT_GT(tracker->position(at(61.0))->radius68_m, before_m + 20.0);
}

TEST(Tracker, ACopyGoesOnExactlyAsTheOriginal) {
  const auto factory = pipeline("p1", hall_site());
  const auto one = factory->make_tracker(Random(1));
  walk_error_m(*one);
  const auto copy = one->clone();
  for (Tracker* each : {one.get(), copy.get()}) {
    for (int i = 0; i < 20; ++i) {
      each->feed(step(24.5 + 0.5 * i, 1.0));
      each->feed(hall().scan_at({30.0, 6.0}, at(24.5 + 0.5 * i)));
    }
  }
  EXPECT_EQ(one->position(at(40.0)), copy->position(at(40.0)));
}

TEST(Tracker, ComesBackFromAWrongPlace) {
  const auto factory = pipeline("p1", hall_site());
  const auto tracker = factory->make_tracker(Random(1), KnownStart{{{400.0, 300.0}, FloorOrdinal{0}}, 0.5, {}});
  EXPECT_LT(walk_error_m(*tracker), 2.0);
}

TEST(Tracker, WorksFarFromTheOrigin) {
  // Web-Mercator-like numbers: a float would be good to half a metre only.
  auto site = hall_site();
  for (auto& point : site->survey) point.place.point = {point.place.point.x_m + 4e6, point.place.point.y_m - 7e6};
  const auto factory = pipeline("p1", site);
  const auto near_factory = pipeline("p1", hall_site());
  const auto far = factory->make_tracker(Random(1));
  const auto near = near_factory->make_tracker(Random(1));
  walk_error_m(*far);
  walk_error_m(*near);
  const BuildingPoint a = far->position(at(24.0))->place.point;
  const BuildingPoint b = near->position(at(24.0))->place.point;
  // The frame has another origin, so floats round differently and a few particles are resampled otherwise.
  EXPECT_NEAR(a.x_m - 4e6, b.x_m, 0.3);
  EXPECT_NEAR(a.y_m + 7e6, b.y_m, 0.3);
}

}  // namespace
}  // namespace wayfuse
