#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include <cmath>
#include <numbers>

#include "server/pipeline/tracker.hpp"
#include "tests/pipeline/block.hpp"

namespace wayfuse {
namespace {

using namespace block;

TEST(FieldTracker, FollowsAWalkerWhoseCompassIsOff) {
  const auto tracker = default_pipeline()->make_tracker(Random(1));
  EXPECT_LT(walk(*tracker, 0.0, 60.0, 0.25), 3.0);
  EXPECT_EQ(tracker->position(PhoneTime(from_seconds(60.0)))->place.floor, FloorOrdinal{1});
}

// Three rows of eleven standing points, 3 m apart, six radios along the walls, no plan; up the hall and back along its middle.
TEST(FieldTracker, StaysInASmallHallThoughTheCompassIsOff) {
  constexpr double kApart_m = 3.0, kLong_m = 10 * kApart_m;
  const auto hall_scan = [](BuildingPoint p, double time_s) {
    RssScan scan{PhoneTime(from_seconds(time_s)), {}};
    for (int radio = 0; radio < 6; ++radio) {
      const BuildingPoint at{kLong_m * radio / 5, radio % 2 ? 2 * kApart_m : 0.0};
      scan.readings.push_back({Bssid{0x00'30'00'00'00'00u + static_cast<std::uint64_t>(radio)}, -38.0 - 22.0 * std::log10(1.0 + distance_m(p, at) / 2.0),
                               Duration{0}, 2437, {}, {}});
    }
    return scan;
  };
  auto site = std::make_shared<Site>();
  site->building = BuildingId{1};
  site->floors.push_back({FloorOrdinal{0}, "0", {}, {}});
  for (int i = 0; i < 33; ++i) {
    const BuildingPoint p{kApart_m * (i / 3), kApart_m * (i % 3)};
    site->survey.push_back({{p, FloorOrdinal{0}}, 0.0, "phone", "", {}, {hall_scan(p, i)}});
  }
  const auto factory = *assemble(*preset("default"), site);
  for (const double compass_error_rad : {-0.2, 0.2}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const auto tracker = factory->make_tracker(Random(seed));
      double worst_m = 0.0;
      for (double t = 0.5; t <= 48.0; t += 0.5) {
        const bool back = kSpeedMps * t > kLong_m;
        tracker->feed(step(t, (back ? std::numbers::pi : 0.0) + compass_error_rad));
        const BuildingPoint truth{back ? 2 * kLong_m - kSpeedMps * t : kSpeedMps * t, kApart_m};
        if (std::fmod(t, 2.0) == 0.0) tracker->feed(hall_scan(truth, t));
        if (const auto position = tracker->position(PhoneTime(from_seconds(t)))) worst_m = std::max(worst_m, distance_m(position->place.point, truth));
      }
      EXPECT_LT(worst_m, 5.0) << "seed " << seed << ", compass off by " << compass_error_rad;
    }
  }
}

// The same scan over and over, walking or not told: it says what it says once, however often it comes.
TEST(FieldTracker, AScanRepeatedAtOnceSaysNothingNew) {
  const auto spread_m = [](double every_s) {
    const auto tracker = default_pipeline()->make_tracker(Random(5));
    const BuildingPoint here = around(20.0);
    for (int k = 0; k < 40; ++k) tracker->feed(scan_at(here, 1, 1.0 + every_s * k));
    const Covariance now = tracker->position(PhoneTime(from_seconds(1.0 + every_s * 39)))->covariance;
    return std::sqrt(now.xx_m2 + now.yy_m2);
  };
  EXPECT_GT(spread_m(0.01), 1.5 * spread_m(5.0));
}

TEST(FieldTracker, AFloorGuessedOnceIsNoSurerForBeingRepeatedAtOnce) {
  const auto surest = [](int scans, double every_s) {
    const auto tracker = default_pipeline()->make_tracker(Random(5));
    for (int k = 0; k < scans; ++k) {
      // Between two floors: one of them a little louder.
      RssScan scan = scan_at(around(20.0), 1, 1.0 + every_s * k);
      for (ScanReading reading : scan_at(around(20.0), 0, 0.0).readings) {
        reading.rss_dbm -= 1.0;
        scan.readings.push_back(reading);
      }
      tracker->feed(scan);
    }
    return tracker->position(PhoneTime(from_seconds(1.0 + every_s * (scans - 1))))->floors.front().probability;
  };
  const double once = surest(1, 1.0);
  ASSERT_GT(once, 0.5);
  ASSERT_LT(once, 0.95);
  EXPECT_NEAR(surest(10, 0.01), once, 0.02);
  EXPECT_GT(surest(10, 10.0), once + 0.04);
}

TEST(FieldTracker, FollowsAPhoneWhoseHeadingHasNoOrigin) {
  const auto tracker = default_pipeline()->make_tracker(Random(2));
  for (double t = 0.5; t <= 90.0; t += 0.5) {
    const BuildingPoint a = around(kSpeedMps * (t - 0.5)), b = around(kSpeedMps * t);
    MotionReport motion = step(t, std::atan2(b.y_m - a.y_m, b.x_m - a.x_m) + 2.0);
    motion.reference = HeadingReference::kArbitrary;
    tracker->feed(motion);
    if (std::fmod(t, 2.0) == 0.0) tracker->feed(scan_at(b, 1, t));
  }
  EXPECT_LT(distance_m(tracker->position(PhoneTime(from_seconds(90.0)))->place.point, around(kSpeedMps * 90.0)), 6.0);
}

TEST(FieldTracker, FindsBackFromAWrongStartWithinFifteenSeconds) {
  const KnownStart wrong{{{0.0, kSide_m}, FloorOrdinal{1}}, 0.5, std::nullopt};
  std::vector<double> errors_m;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto tracker = default_pipeline()->make_tracker(Random(seed), wrong);
    walk(*tracker, 0.0, 15.0, 0.0);
    errors_m.push_back(distance_m(tracker->position(PhoneTime(from_seconds(15.0)))->place.point, around(kSpeedMps * 15.0)));
  }
  std::ranges::sort(errors_m);
  EXPECT_LT(errors_m[37], 10.0) << "95 % [SAFETY R19]; median " << errors_m[19];
}

TEST(FieldTracker, AFirstScanThatErredIsSoonMadeUpFor) {
  double sum_m = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto tracker = default_pipeline()->make_tracker(Random(seed));
    tracker->feed(scan_at(around(-15.0), 1, 0.0));
    sum_m += walk(*tracker, 0.0, 8.0, 0.0) / 40.0;
  }
  EXPECT_LT(sum_m, 10.5);
}

// To the opposite side of the block, on another floor.
TEST(FieldTracker, CarriedOffItIsFoundWithinFifteenSeconds) {
  std::vector<double> errors_m;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto tracker = default_pipeline()->make_tracker(Random(seed));
    walk(*tracker, 0.0, 40.0, 0.0);
    BuildingPoint now;
    for (double t = 40.5; t <= 55.0; t += 0.5) {
      const BuildingPoint a = around(kSpeedMps * (t - 0.5) + 2 * kSide_m);
      now = around(kSpeedMps * t + 2 * kSide_m);
      tracker->feed(step(t, std::atan2(now.y_m - a.y_m, now.x_m - a.x_m)));
      if (std::fmod(t, 2.0) == 0.0) tracker->feed(scan_at(now, 0, t));
    }
    const auto position = *tracker->position(PhoneTime(from_seconds(55.0)));
    errors_m.push_back(position.place.floor == FloorOrdinal{0} ? distance_m(position.place.point, now) : 100.0);
  }
  std::ranges::sort(errors_m);
  EXPECT_LT(errors_m[18], 10.0) << "95 % [SAFETY R19]; median " << errors_m[9];
}

// Ten seconds to settle, then a minute: nowhere in it, and on no other floor, though scans say now this, now that.
TEST(FieldTracker, APhoneLyingStillStaysWhereItIs) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto tracker = default_pipeline()->make_tracker(Random(seed));
    walk(*tracker, 0.0, 20.0, 0.0);
    Random noise(seed + 100);
    BuildingPoint settled;
    for (double t = 20.5; t <= 90.0; t += 0.5) {
      tracker->feed(rest(t));
      if (std::fmod(t, 2.0) == 0.0) {
        RssScan scan = scan_at(around(kSpeedMps * 20.0), 1, t);
        for (ScanReading& reading : scan.readings) reading.rss_dbm += 4.0 * noise.normal();
        tracker->feed(scan);
      }
      const Place now = tracker->position(PhoneTime(from_seconds(t)))->place;
      ASSERT_EQ(now.floor, FloorOrdinal{1}) << "seed " << seed << ", " << t << " s";
      if (t == 30.0) settled = now.point;
      if (t > 30.0) { ASSERT_LT(distance_m(now.point, settled), 0.3) << "seed " << seed << ", " << t << " s"; }
    }
  }
}

/// The second half of half a minute round the block, ten seeds.
struct Heard {
  double error_m = 0.0;            ///< on average
  double radius68_m = 0.0;         ///< on average
  double doubtful = 0.0;           ///< share of the positions that are not `ok`
};
Heard round_of_a_phone(double louder_db, double begin_s) {
  Heard heard;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto tracker = default_pipeline()->make_tracker(Random(seed));
    if (begin_s > 0.0) walk(*tracker, 0.0, begin_s, 0.1, louder_db);
    heard.error_m += walk(*tracker, begin_s, begin_s + 16.0, 0.1, louder_db) / 10.0;
    for (double t = begin_s + 16.0; t < begin_s + 30.0; t += 2.0) {
      walk(*tracker, t, t + 2.0, 0.1, louder_db);
      const auto position = tracker->position(PhoneTime(from_seconds(t + 2.0)));
      heard.radius68_m += position->radius68_m / 70.0;
      heard.doubtful += position->integrity != Integrity::kOk ? 1.0 / 70.0 : 0.0;
    }
  }
  return heard;
}

// At first its scans are like no surveyed place; a minute later the tracker knows how loud it hears.
TEST(FieldTracker, ALouderPhoneIsNotWorseForLong) {
  const Heard usual = round_of_a_phone(0.0, 60.0);
  for (const double louder_db : {-9.0, 10.0}) {
    EXPECT_GT(round_of_a_phone(louder_db, 0.0).doubtful, 0.5) << louder_db << ": the test would show nothing";
    const Heard later = round_of_a_phone(louder_db, 60.0);
    EXPECT_EQ(later.doubtful, 0.0) << louder_db;
    EXPECT_LT(later.radius68_m, 1.35 * usual.radius68_m) << louder_db;
    EXPECT_LT(later.error_m, usual.error_m + 0.7) << louder_db;
  }
}

TEST(FieldTracker, ALiftTakesAPhoneAtRestToAnotherFloor) {
  const auto tracker = default_pipeline()->make_tracker(Random(5));
  walk(*tracker, 0.0, 20.0, 0.0);
  for (double t = 20.5; t <= 60.0; t += 0.5) {
    tracker->feed(rest(t));
    if (std::fmod(t, 2.0) == 0.0) tracker->feed(scan_at(around(kSpeedMps * 20.0), t < 40.0 ? 1 : 0, t));
  }
  EXPECT_EQ(tracker->position(PhoneTime(from_seconds(60.0)))->place.floor, FloorOrdinal{0});
}

// The phone felt the lift and tells how far it went: the first scan from up there is not one of a phone that has heard it all.
TEST(FieldTracker, ALiftThatWasFeltNeedsFewerScans) {
  const auto scans_needed = [](std::optional<double> climb_m) {
    auto tracker = default_pipeline()->make_tracker(Random(1));
    walk(*tracker, 0.0, 20.0, 0.0);
    for (double t = 20.5; t < 40.0; t += 0.5) {
      tracker->feed(rest(t));
      if (std::fmod(t, 2.0) == 0.0) tracker->feed(scan_at(around(kSpeedMps * 20.0), 1, t));
    }
    MotionReport arrived = rest(40.0);
    arrived.climb_m = climb_m;
    tracker->feed(arrived);
    int scans = 0;
    for (double t = 40.5; t < 70.0; t += 0.5) {
      tracker->feed(rest(t));
      if (std::fmod(t, 2.0) != 0.0) continue;
      tracker->feed(scan_at(around(kSpeedMps * 20.0), 0, t));
      ++scans;
      if (tracker->position(PhoneTime(from_seconds(t)))->place.floor == FloorOrdinal{0}) return scans;
    }
    return 100;
  };
  const int felt = scans_needed(-3.6), unfelt = scans_needed(std::nullopt);
  EXPECT_LT(felt, unfelt);
  EXPECT_LE(felt, 2);
}

TEST(FieldTracker, ThreeStrongRadiosOutOfPlaceAreSuspect) {
  const auto tracker = default_pipeline()->make_tracker(Random(6));
  walk(*tracker, 0.0, 20.0, 0.0);
  EXPECT_EQ(tracker->position(PhoneTime(from_seconds(20.0)))->integrity, Integrity::kOk);
  RssScan scan = scan_at(around(kSpeedMps * 20.0), 1, 20.5);
  for (std::uint64_t i = 0; i < 3; ++i) scan.readings.push_back({Bssid{0x00'99'00'00'00'00u + i}, -30.0, Duration{0}, 2412, {}, {}});
  tracker->feed(scan);
  const auto position = tracker->position(PhoneTime(from_seconds(20.5)));
  EXPECT_EQ(position->integrity, Integrity::kSuspect);
  EXPECT_THAT(tracker->doubts(PhoneTime(from_seconds(20.5))), testing::Contains(testing::HasSubstr("strong access points do not belong")));
  EXPECT_LT(distance_m(position->place.point, around(kSpeedMps * 20.0)), 5.0);
}

// A scan in 30 s is all that a phone's system allows an application: no fault of the phone's, as long as they come.
TEST(FieldTracker, AThrottledPhoneIsDegradedOnlyWhenItsScansStopComing) {
  const auto tracker = default_pipeline()->make_tracker(Random(7));
  for (double t = 0.5; t <= 130.0; t += 0.5) {
    const BuildingPoint a = around(kSpeedMps * (t - 0.5)), b = around(kSpeedMps * t);
    tracker->feed(step(t, std::atan2(b.y_m - a.y_m, b.x_m - a.x_m)));
    if (std::fmod(t, 30.0) == 1.0 && t < 100.0) tracker->feed(scan_at(b, 1, t));
    if (t < 1.0) continue;
    const auto position = tracker->position(PhoneTime(from_seconds(t)));
    ASSERT_TRUE(position);
    EXPECT_EQ(position->integrity, Integrity::kOk) << t;
    if (t > 40.0) {
      EXPECT_LT(distance_m(position->place.point, b), 8.0) << t;
    }
  }
  const PhoneTime late(from_seconds(133.0));
  EXPECT_EQ(tracker->position(late)->integrity, Integrity::kDegraded);
  EXPECT_THAT(tracker->doubts(late), testing::Contains(testing::HasSubstr("no known access point was heard for 40 s")));
}

TEST(FieldTracker, SameSeedSameBitsAndACloneGoesOnAlike) {
  const auto a = default_pipeline()->make_tracker(Random(8));
  walk(*a, 0.0, 20.0, 0.1);
  const auto b = a->clone();
  walk(*a, 20.0, 30.0, 0.1);
  walk(*b, 20.0, 30.0, 0.1);
  EXPECT_EQ(a->position(PhoneTime(from_seconds(30.0))), b->position(PhoneTime(from_seconds(30.0))));
}

TEST(FieldTracker, OddEvidenceNeverPublishesANaN) {
  Random random(11);
  const auto tracker = default_pipeline()->make_tracker(Random(12));
  const double values[] = {0.0, -1.0, 1.0, 1e9, -1e9, NAN, INFINITY, 1e-300};
  const auto odd = [&] { return values[random.below(8)]; };
  double t = 0.0;
  for (int i = 0; i < 4000; ++i) {
    t += random.uniform();
    if (random.below(2)) {
      MotionReport motion = step(t, 0.3);
      motion.heading = Heading::from_radians(odd());
      motion.step_length_m = odd();
      motion.heading_sigma_rad = odd();
      if (random.below(4) == 0) motion.interval = from_seconds(random.uniform() * 60.0);
      tracker->feed(motion);
    } else {
      RssScan scan = scan_at(around(t), 1, t);
      for (ScanReading& reading : scan.readings) {
        if (random.below(3) == 0) reading.rss_dbm = odd();
      }
      tracker->feed(scan);
    }
    if (const auto position = tracker->position(PhoneTime(from_seconds(t)))) {
      ASSERT_TRUE(std::isfinite(position->place.point.x_m) && std::isfinite(position->place.point.y_m)) << i;
      ASSERT_TRUE(std::isfinite(position->radius68_m) && std::isfinite(position->radius95_m)) << i;
    }
  }
}

TEST(FieldTracker, AnEmptyMapSaysSo) {
  const auto factory = assemble(*preset("default"), std::make_shared<Site>());
  ASSERT_TRUE(factory);
  const auto tracker = (*factory)->make_tracker(Random(1));
  tracker->feed(scan_at({0, 0}, 0, 1.0));
  EXPECT_FALSE(tracker->position(PhoneTime(from_seconds(1.0))));
  EXPECT_EQ(tracker->why_no_fix().code, FaultCode::kEmptyRadioMap);
}

TEST(FieldTracker, WalkersRefuseRolesTheyBringThemselves) {
  PipelineSpec spec = *preset("default");
  spec.parts["motion"] = {"walk", {}};
  EXPECT_EQ(assemble(spec, block_site()).fault().field, "parts.motion");
  spec.parts.erase("motion");
  spec.parts["locator"] = {"wknn", {}};
  EXPECT_EQ(assemble(spec, block_site()).fault().field, "parts.locator");
}

}  // namespace
}  // namespace wayfuse
