#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "server/pipeline/tracker.hpp"
#include "tests/pipeline/block.hpp"
#include "tests/pipeline/told.hpp"

// What a phone reports and how it hears, and what the project's own tracker makes of it.

namespace wayfuse {
namespace {

using namespace block;

constexpr FloorOrdinal kGround{0}, kFirst{1};

double spread_m(const FusedPosition& p) { return std::sqrt(p.covariance.xx_m2 + p.covariance.yy_m2); }

TEST(Phone, WhoseLocatorVotesForNoFloorStandsOnItsFixsFloor) {
  ToldPhone phone(1);
  phone.told->floor = FloorOrdinal{2};
  FusedPosition position;
  for (int i = 0; i < 10; ++i) {
    phone.go(2.0, 0.0, 2.0);
    position = phone.hear({2.0 * i, 0.0});
  }
  EXPECT_EQ(position.place.floor, FloorOrdinal{2});
  ASSERT_EQ(position.floors.size(), 1u);
  EXPECT_EQ(position.floors.front(), (FloorProbability{FloorOrdinal{2}, 1.0}));
  EXPECT_LT(distance_m(position.place.point, {18.0, 0.0}), 3.0);
}

// Straight on; scans err by 4 m an axis, and alike for longer than the cloud takes them to.
TEST(Phone, CirclesHoldAsOftenAsTheySay) {
  const double kept = std::exp(-2.0 / 10.0), fresh_m = 4.0 * std::sqrt(1.0 - kept * kept);
  int asked = 0, in68 = 0, in95 = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    ToldPhone phone(seed);
    Random noise(seed + 100);
    BuildingPoint error;
    for (int i = 0; i <= 40; ++i) {
      const BuildingPoint truth{2.5 * i, 0.0};
      if (i > 0) phone.go(2.5, 0.1, 2.0);
      const double x_m = noise.normal(), y_m = noise.normal();
      error = {kept * error.x_m + fresh_m * x_m, kept * error.y_m + fresh_m * y_m};
      const FusedPosition now = phone.hear({truth.x_m + error.x_m, truth.y_m + error.y_m});
      if (i < 10) continue;
      const double off_m = distance_m(now.place.point, truth);
      ++asked, in68 += off_m <= now.radius68_m, in95 += off_m <= now.radius95_m;
    }
  }
  EXPECT_GT(in68, 0.60 * asked);
  EXPECT_LT(in68, 0.80 * asked);
  EXPECT_GT(in95, 0.93 * asked);
}

TEST(Phone, ScansThatFitNothingWidenTheCircles) {
  const auto heard = [](double mismatch) {
    ToldPhone phone(2);
    phone.told->mismatch = mismatch;
    for (int i = 0; i < 10; ++i) phone.go(2.0, 0.0, 2.0), phone.hear({2.0 * i, 0.0});
    return phone.position();
  };
  const FusedPosition better = heard(0.5), usual = heard(1.0), strange = heard(3.0);
  ASSERT_EQ(usual.place.point, strange.place.point) << "the same cloud";
  EXPECT_EQ(better.radius68_m, usual.radius68_m);
  EXPECT_GT(strange.radius68_m, 1.25 * usual.radius68_m);
  EXPECT_GT(strange.radius95_m, 1.25 * usual.radius95_m);
}

// Scans that come late know how late: the track is where the phone is, not where it was.
TEST(Phone, IsWhereItIsNowThoughItsScansAreLate) {
  for (const double late_s : {0.0, 2.0, 5.0}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      ToldPhone phone(seed);
      phone.told->heard_before = from_seconds(late_s);
      double sum_m = 0.0;
      for (int i = 1; i <= 60; ++i) {
        phone.go(0.7, 0.5, 0.5);
        const auto at = [&](double ago_s) {
          const double along_m = 0.7 * i - 1.4 * ago_s;
          return BuildingPoint{along_m * std::cos(0.5), along_m * std::sin(0.5)};
        };
        if (i % 4 == 0) phone.hear(at(late_s));
        if (i > 20) sum_m += distance_m(phone.position().place.point, at(0.0)) / 40.0;
      }
      EXPECT_LT(sum_m, 2.0) << "seed " << seed << ", " << late_s << " s late";
    }
  }
}

/// The block, surveyed by a phone whose stamps are `late_s` before what they show was heard.
std::shared_ptr<const Site> stamped_early(double late_s) {
  auto site = std::make_shared<Site>();
  site->building = BuildingId{1};
  site->floors.push_back({kFirst, "1", {}, {}});
  for (int walk = 0; walk < 8; ++walk) {
    for (int i = 0; i <= 96; ++i) {
      const double mps = walk % 2 ? -kSpeedMps : kSpeedMps, start_s = 3.0 * walk;
      site->survey.push_back({{around(mps * (start_s + i)), kFirst}, 0.0, "phone", "w" + std::to_string(walk), {},
                              {scan_at(around(mps * (start_s + i + late_s)), 1, i)}});
    }
  }
  return site;
}
// Along the first side, scans 2 s old: a delay left out of account would be 3 m of lag.
TEST(Phone, ADelayLearntFromTheSurveyIsTheWalkersToo) {
  for (const double late_s : {0.0, 2.6}) {
    const auto factory = *assemble(*preset("default"), stamped_early(late_s));
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto tracker = factory->make_tracker(Random(seed));
      double ahead_m = 0.0;
      for (double t = 0.5; t <= 22.0; t += 0.5) {
        tracker->feed(step(t, 0.0));
        if (std::fmod(t, 2.0) == 0.0) {
          RssScan scan = scan_at(around(kSpeedMps * (t - 2.0 + late_s)), 1, t);
          for (ScanReading& reading : scan.readings) reading.age = from_seconds(2.0);
          tracker->feed(scan);
        }
        if (t > 6.0) ahead_m += (tracker->position(PhoneTime(from_seconds(t)))->place.point.x_m - kSpeedMps * t) / 32.0;
      }
      EXPECT_NEAR(ahead_m, 0.0, 1.0) << "seed " << seed << ", " << late_s << " s late";
    }
  }
}

const KnownStart kDoor{{{0.0, 0.0}, kGround}, 0.5, std::nullopt};

/// From the door 25 m along the x axis, nothing heard on the way; how far off it ends, at worst.
double blind_error_m(const Site& site, const KnownStart& start, HeadingReference reference, Heading heading) {
  double worst_m = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    ToldPhone phone(seed, {}, start, site);
    for (int i = 0; i < 40; ++i) {
      MotionReport motion = step(0.0, 0.0);
      motion.reference = reference;
      motion.heading = heading;
      phone.feed(motion, 0.5);
    }
    worst_m = std::max(worst_m, distance_m(phone.position().place.point, {40 * 0.5 * kSpeedMps, 0.0}));
  }
  return worst_m;
}

// Declination and the building's turn by their definitions: azimuths, clockwise from north.
TEST(Phone, HeadsTheSameWayWhateverItsCompassIsReadAgainst) {
  for (const double declination_rad : {-0.5, 0.0, 0.5}) {
    for (const double y_axis_rad : {0.0, 1.0, -2.5}) {
      Site site;
      site.magnetic_field.declination_rad = declination_rad;
      site.georeference = Georeference{{47.0, 8.0}, y_axis_rad};
      const double true_rad = y_axis_rad + std::numbers::pi / 2;  // the x axis is a quarter clockwise of the y axis
      const double magnetic_rad = true_rad - declination_rad;     // counted from a north that is turned clockwise itself
      const auto error_m = [&](HeadingReference reference, double azimuth_rad) {
        return blind_error_m(site, kDoor, reference, Heading::from_azimuth(azimuth_rad));
      };
      EXPECT_LT(error_m(HeadingReference::kTrue, true_rad), 3.0) << declination_rad << ", " << y_axis_rad;
      EXPECT_LT(error_m(HeadingReference::kMagnetic, magnetic_rad), 3.0) << declination_rad << ", " << y_axis_rad;
    }
  }
}

TEST(Phone, WhoseHeadingHasNoOriginTakesItFromAStartThatKnowsIt) {
  KnownStart start = kDoor;
  start.heading = Heading::from_radians(0.0);
  for (const double origin_rad : {-2.0, 0.0, 3.0}) {
    EXPECT_LT(blind_error_m({}, start, HeadingReference::kArbitrary, Heading::from_radians(origin_rad)), 3.0) << origin_rad;
  }
  EXPECT_GT(blind_error_m({}, kDoor, HeadingReference::kArbitrary, {}), 10.0) << "nothing says whither";
}

/// On the ground floor for long; then stairs or none, and so long without a scan; then scans that take the first floor for somewhat
/// likelier. How many until the track is there; 31: not within thirty.
int scans_to_change_floors(double climb_m, int unheard_s) {
  ToldPhone phone(1, {.second_opinion = false});
  phone.told->votes = {{kGround, 0.9}, {kFirst, 0.1}};
  for (int i = 0; i < 30; ++i) phone.go(1.0, 0.0, 2.0), phone.hear({1.0 * i, 0.0});
  for (int i = 0; i < 20; ++i) phone.go(0.6, 0.0, 0.6, climb_m / 20.0);
  for (int i = 0; i < unheard_s; ++i) phone.go(1.0, 0.0, 1.0);
  phone.told->votes = {{kFirst, 0.7}, {kGround, 0.3}};
  phone.told->floor = kFirst;
  int scans = 1;
  for (; scans <= 30; ++scans) {
    phone.go(1.0, 0.0, 2.0);
    if (phone.hear({42.0 + unheard_s + scans, 0.0}).place.floor == kFirst) break;
  }
  return scans;
}

TEST(Phone, ThatFeltAFloorsHeightChangesFloorsSooner) {
  EXPECT_GT(scans_to_change_floors(0.0, 0), 10) << "on the level";
  EXPECT_LE(scans_to_change_floors(3.5, 0), 5) << "a stair of twenty steps, none of them a floor high";
  EXPECT_LE(scans_to_change_floors(-3.5, 3), 5);
  EXPECT_GT(scans_to_change_floors(3.5, 120), 10) << "two minutes ago: another stair's business";
}

TEST(Phone, OnStairsNobodyKnowsTheStride) {
  const auto along_m = [](double climb_m) {
    ToldPhone phone(3, {.stride_sigma = 0.0, .stray_strides = 0.0}, kDoor);
    for (int i = 0; i < 20; ++i) phone.go(0.6, 0.0, 0.6, climb_m / 20.0);
    return std::sqrt(phone.position().covariance.xx_m2);
  };
  for (const double climb_m : {4.0, -4.0}) EXPECT_GT(along_m(climb_m), 1.2 * along_m(0.0)) << climb_m;
  EXPECT_EQ(along_m(1.0), along_m(0.0)) << "a ramp";
}

// Off by 25 m when it steps out upstairs: the first scan there is heard, though hardly a walker stands where it says; or calls up a rival,
// which the second makes the track.
TEST(Phone, IsLookedForAnewOnANewFloor) {
  for (const bool second_opinion : {false, true}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      ToldPhone phone(seed, {.second_opinion = second_opinion});
      phone.told->most = 10.0;
      phone.told->votes = {{kGround, 0.99}, {kFirst, 0.01}};
      for (int i = 0; i < 15; ++i) phone.go(1.0, 0.0, 2.0), phone.hear({1.0 * i, 0.0});
      phone.go(1.0, 0.0, 2.0, 3.5);
      phone.told->votes = {{kFirst, 0.9999}, {kGround, 0.0001}};
      phone.told->floor = kFirst;
      const FusedPosition first = phone.hear({15.0, 25.0});
      EXPECT_EQ(first.place.floor, kFirst);
      if (!second_opinion) {
        EXPECT_LT(distance_m(first.place.point, {15.0, 25.0}), 20.0) << "seed " << seed;
      }
      phone.go(1.0, 0.0, 2.0);
      const FusedPosition second = phone.hear({16.0, 25.0});
      EXPECT_LT(distance_m(second.place.point, {16.0, 25.0}), 10.0) << "seed " << seed;
    }
  }
}

// Between two floors votes change from scan to scan; a lift that was not felt is three of them in a row.
TEST(Phone, LyingStillChangesFloorsForThreeScansInARow) {
  ToldPhone phone(6, {.second_opinion = false});
  const auto hear = [&](int scans, FloorOrdinal floor) {
    phone.told->votes = {{floor, 0.9999}, {floor == kGround ? kFirst : kGround, 0.0001}};
    FusedPosition now;
    for (int i = 0; i < scans; ++i) phone.go(0.0, 0.0, 4.0), now = phone.hear();
    return now.place.floor;
  };
  hear(6, kGround);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(hear(2, kFirst), kGround);
    EXPECT_EQ(hear(1, kGround), kGround);
  }
  EXPECT_EQ(hear(3, kFirst), kFirst);
}

// A metre a second, an axis, for as long as it was silent, and 50 m at most; a short silence is none.
TEST(Phone, SilentForLongMayBeAnywhereWithinAStroll) {
  for (const double step_m : {0.0, 0.6}) {
    const auto after_m = [&](double pause_s) {
      ToldPhone phone(4, {}, kDoor);
      phone.go(0.6, 0.0, 0.5);
      phone.go(step_m, 0.0, 0.5, 0.0, pause_s);
      return spread_m(phone.position());
    };
    EXPECT_LT(after_m(4.0), 1.5) << step_m;
    EXPECT_NEAR(after_m(30.0), std::sqrt(2.0) * 30.0, 4.0) << step_m;
    EXPECT_NEAR(after_m(60.0), std::sqrt(2.0) * 50.0, 6.0) << step_m;
    EXPECT_NEAR(after_m(3600.0), std::sqrt(2.0) * 50.0, 6.0) << step_m;
  }
}

TEST(Phone, ThatReportsForAQuarterOfAMinuteAtOnceMayHaveGoneRoundACorner) {
  ToldPhone at_once(5, {}, kDoor), bit_by_bit(5, {}, kDoor);
  at_once.go(18.0, 0.0, 15.0);
  for (int i = 0; i < 15; ++i) bit_by_bit.go(1.2, 0.0, 1.0);
  EXPECT_GT(spread_m(at_once.position()), 1.7 * spread_m(bit_by_bit.position()));
  EXPECT_LT(spread_m(at_once.position()), 18.0);
}

}  // namespace
}  // namespace wayfuse
