#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "wayfuse/proto/fault.hpp"
#include "wayfuse/proto/heading.hpp"
#include "wayfuse/proto/motion.hpp"
#include "wayfuse/proto/part.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/proto/scan.hpp"

namespace wayfuse {
namespace {

using namespace std::chrono_literals;

constexpr double kPi = std::numbers::pi;

//        N az 0
//        |
//  W ----+---- E heading 0
//        |
//        S heading -pi/2
TEST(Heading, MeetsTheCompassInFourQuadrants) {
  EXPECT_DOUBLE_EQ(Heading::from_azimuth(0).radians(), kPi / 2);
  EXPECT_DOUBLE_EQ(Heading::from_azimuth(kPi / 2).radians(), 0);
  EXPECT_DOUBLE_EQ(Heading::from_azimuth(kPi).radians(), -kPi / 2);
  EXPECT_DOUBLE_EQ(Heading::from_azimuth(3 * kPi / 2).radians(), kPi);
  for (double azimuth = 0.0; azimuth < 2 * kPi; azimuth += 0.01) {
    EXPECT_NEAR(Heading::from_azimuth(azimuth).azimuth_rad(), azimuth, 1e-12);
  }
}

TEST(Heading, TurnsTheShortWayAcrossTheWrap) {
  const Heading a = Heading::from_radians(kPi - 0.1);
  const Heading b = Heading::from_radians(-kPi + 0.1);
  EXPECT_NEAR(b.minus(a), 0.2, 1e-12);
  EXPECT_NEAR(a.minus(b), -0.2, 1e-12);
}

TEST(Georeference, RoundTripsWithinAMillimetreOverFiveKilometres) {
  const Georeference frame{{47.3769, 8.5417}, 0.4};
  for (double x = -5000; x <= 5000; x += 1250) {
    for (double y = -5000; y <= 5000; y += 1250) {
      EXPECT_LT(distance_m(frame.to_building(frame.to_geo({x, y})), {x, y}), 1e-3);
    }
  }
}

TEST(Georeference, TurnsTheFrameClockwiseByItsAzimuth) {
  // The y axis points east: walking along y is walking east.
  const Georeference frame{{0, 0}, kPi / 2};
  EXPECT_GT(frame.to_geo({0, 100}).longitude_deg, 0.0008);
  EXPECT_NEAR(frame.to_geo({0, 100}).latitude_deg, 0, 1e-9);
  EXPECT_NEAR(frame.to_building(Heading::from_azimuth(kPi / 2)).azimuth_rad(), 0, 1e-12);
  EXPECT_NEAR(frame.to_true(frame.to_building(Heading::from_radians(1))).radians(), 1, 1e-12);
}

//  +--------+
//  |  +--+  |
//  |  |  |  |   the hole is outside
//  |  +--+  |
//  +--------+
TEST(Polygon, LeavesItsHolesOut) {
  const Polygon polygon{{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {{4, 4}, {6, 4}, {6, 6}, {4, 6}}}};
  EXPECT_TRUE(contains(polygon, {2, 2}));
  EXPECT_FALSE(contains(polygon, {5, 5}));
  EXPECT_FALSE(contains(polygon, {11, 5}));
}

TEST(Random, GivesTheSameBitsForTheSameSeed) {
  Random a(7);
  Random b(7);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(a.bits(), b.bits());
  Random c(1);
  c.restore(a.state());
  EXPECT_EQ(a.normal(), c.normal());
}

TEST(Random, DrawsANormalOfUnitVariance) {
  Random random(3);
  double sum = 0, squares = 0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / kDraws, 0, 0.01);       // standard error 0.0022
  EXPECT_NEAR(squares / kDraws, 1, 0.015);  // standard error 0.0032
}

TEST(Random, CoversASmallRangeEvenly) {
  Random random(5);
  int counts[6] = {};
  for (int i = 0; i < 60000; ++i) ++counts[random.below(6)];
  for (int count : counts) EXPECT_NEAR(count, 10000, 500);  // standard error 91
}

TEST(Bssid, ReadsWhatPeopleWrite) {
  for (const char* text : {"01:23:45:67:89:ab", "01-23-45-67-89-AB", "0123456789ab"}) {
    ASSERT_TRUE(parse_bssid(text)) << text;
    EXPECT_EQ(to_string(*parse_bssid(text)), "01:23:45:67:89:ab");
  }
  for (const char* text : {"", "01:23:45:67:89", "01:23:45-67:89:ab", "0g:23:45:67:89:ab", "01:23:45:67:89:ab:"}) {
    EXPECT_FALSE(parse_bssid(text)) << text;
  }
  EXPECT_TRUE(parse_bssid("02:00:00:00:00:00")->locally_administered());
}

TEST(RssScan, KeepsItsYoungestReadings) {
  const auto reading = [](std::uint64_t bssid, Duration age) { return ScanReading{Bssid{bssid}, -60, age, 0, {}, {}}; };
  RssScan scan{PhoneTime{}, {reading(1, 3s), reading(2, 1s), reading(3, 2s), reading(4, 1s)}};
  const RssScan whole = scan;
  EXPECT_EQ(keep_youngest(scan, 4), 0u);
  EXPECT_EQ(scan, whole);
  EXPECT_EQ(keep_youngest(scan, 3), 1u);
  EXPECT_EQ(scan.readings, (std::vector{reading(2, 1s), reading(4, 1s), reading(3, 2s)}));
}

TEST(MotionReport, CountsStepsBeforeSpeedAndNothingAtRest) {
  MotionReport motion;
  motion.interval = from_seconds(2);
  motion.speed_mps = 1.5;
  EXPECT_DOUBLE_EQ(motion.distance_m(), 3.0);
  motion.steps = 2;
  motion.step_length_m = 0.7;
  EXPECT_DOUBLE_EQ(motion.distance_m(), 1.4);
  motion.at_rest = true;
  EXPECT_EQ(motion.distance_m(), 0.0);
}

TEST(FaultTable, HoldsEveryCodeOnceInOrder) {
  std::set<std::string_view> names;
  FaultCode last{};
  for (const FaultFace& face : fault_table()) {
    EXPECT_GT(face.code, last);
    last = face.code;
    EXPECT_TRUE(names.insert(face.name).second) << face.name;
    EXPECT_GE(face.http_status, 400);
    EXPECT_EQ(&face_of(face.code), &face);
  }
  EXPECT_EQ(last, FaultCode::kInternal);
}

TEST(Fault, SaysNameFieldAndCause) {
  EXPECT_EQ(to_string(Fault{FaultCode::kOutOfRange, "readings[3].rss_dbm", "-312 is outside -120..0"}),
            "out_of_range: readings[3].rss_dbm: -312 is outside -120..0");
}

#ifndef NDEBUG
TEST(PartSettings, ASettingThatTheRowDoesNotDescribeIsNamed) {
  const PartDescription part{"locator", "mine", "", {{"k", 4, 1, 64, "", "-"}, {"floor_dbm", -100, -120, -60, "", "-"}}};
  const PartSettings settings = *check_settings(part, {"mine", {}}, "");
  EXPECT_DEATH(settings["sigma_m"], "no setting `sigma_m`; it has: floor_dbm, k");
}
#endif

}  // namespace
}  // namespace wayfuse
