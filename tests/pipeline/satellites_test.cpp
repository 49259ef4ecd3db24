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

// The block with its outline, somewhere on the earth.
std::shared_ptr<const TrackerFactory> planned() {
  static const auto factory = [] {
    auto site = std::make_shared<Site>(*block::block_site());
    site->georeference = Georeference{{47.0, 8.0}, 0.3};
    for (Floor& floor : site->floors) floor.outline = {{{{-2, -2}, {kSide_m + 2, -2}, {kSide_m + 2, kSide_m + 2}, {-2, kSide_m + 2}}}};
    return *assemble(*preset("default"), site);
  }();
  return factory;
}

GnssFix fix_at(BuildingPoint p, double sigma_m, double time_s) {
  static const Georeference earth{{47.0, 8.0}, 0.3};
  return {PhoneTime(from_seconds(time_s)), earth.to_geo(p), sigma_m, {}, {}};
}

BuildingPoint off(BuildingPoint p, double sigma_m, Random& noise) {
  const double x = noise.normal(), y = noise.normal();
  return {p.x_m + sigma_m * x, p.y_m + sigma_m * y};
}

FusedPosition position_at(const Tracker& tracker, double time_s) { return *tracker.position(PhoneTime(from_seconds(time_s))); }

// Out through the wall in the south, 60 m straight on and back; the building is heard all the way, fainter. Then round the block again.
struct Outing {
  double worst_outside_m = 0.0;  ///< from 20 m off the wall on, on the way out
  double error_back_in_m = 0.0;
};
Outing outing(std::uint64_t seed, double compass_error_rad) {
  const auto tracker = planned()->make_tracker(Random(seed));
  walk(*tracker, 0.0, 24.0, 0.0);  // to the end of the south side
  Random noise(seed + 100);
  Outing outing;
  for (double t = 24.5; t <= 120.0; t += 0.5) {
    tracker->feed(step(t, (t <= 72.0 ? -1.0 : 1.0) * std::numbers::pi / 2 + compass_error_rad));
    const BuildingPoint p{around(kSpeedMps * 24.0).x_m, -(t < 72.0 ? t - 24.0 : 120.0 - t) * kSpeedMps};
    if (std::fmod(t, 2.0) == 0.0) tracker->feed(scan_at(p, 1, t));
    if (p.y_m > -6.0 || std::fmod(t, 1.0) != 0.0) continue;
    tracker->feed(fix_at(off(p, 4.0, noise), 5.0, t));
    if (p.y_m > -20.0 || t > 72.0) continue;
    outing.worst_outside_m = std::max(outing.worst_outside_m, distance_m(position_at(*tracker, t).place.point, p));
  }
  walk(*tracker, 120.0, 160.0, compass_error_rad);
  outing.error_back_in_m = distance_m(position_at(*tracker, 160.0).place.point, around(kSpeedMps * 160.0));
  return outing;
}

TEST(Satellites, TakeThePhoneOutOfTheBuildingAndBackIn) {
  for (const double compass_error_rad : {0.0, 0.3}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Outing one = outing(seed, compass_error_rad);
      EXPECT_LT(one.worst_outside_m, compass_error_rad == 0.0 ? 9.0 : 14.0) << "seed " << seed << ", compass off by " << compass_error_rad;
      EXPECT_LT(one.error_back_in_m, 5.0) << "seed " << seed << ", compass off by " << compass_error_rad;
    }
  }
}

// Off the plan, where nothing else speaks: a fix counts by what its receiver says of it.
TEST(Satellites, WeighByTheSigmaTheirReceiverStates) {
  const auto drawn_m = [](double sigma_m) {
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const auto tracker = planned()->make_tracker(Random(seed));
      tracker->feed(fix_at({100.0, 50.0}, 6.0, 0.0));
      tracker->feed(fix_at({112.0, 50.0}, sigma_m, 60.0));
      sum += position_at(*tracker, 60.0).place.point.x_m - 100.0;
    }
    return sum / 10.0;
  };
  EXPECT_NEAR(drawn_m(6.0), 6.0, 1.0) << "as much as the first";
  EXPECT_NEAR(drawn_m(12.0), 12.0 / 5.0, 1.0);
  EXPECT_GT(drawn_m(3.0), 8.5);
}

// A minute at rest by the window, a fix a second.
TEST(Satellites, APhoneLyingStillStaysWhereItIs) {
  for (const double sigma_m : {5.0, 12.0}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const auto tracker = planned()->make_tracker(Random(seed));
      walk(*tracker, 0.0, 20.0, 0.0);
      const BuildingPoint here = around(kSpeedMps * 20.0);
      Random noise(seed + 100);
      BuildingPoint settled;
      for (double t = 20.5; t <= 90.0; t += 0.5) {
        tracker->feed(rest(t));
        if (std::fmod(t, 2.0) == 0.0) tracker->feed(scan_at(here, 1, t));
        if (std::fmod(t, 1.0) == 0.0) tracker->feed(fix_at(off(here, sigma_m, noise), sigma_m, t));
        const FusedPosition now = position_at(*tracker, t);
        if (t == 30.0) settled = now.place.point;
        if (t > 30.0) {
          ASSERT_LT(distance_m(now.place.point, settled), 0.3) << "seed " << seed << ", " << t << " s";
        }
        ASSERT_EQ(now.place.floor, FloorOrdinal{1});
      }
    }
  }
}

// Fixes whose error lasts: the same all the time, or wandering with a memory of 20 s.
TEST(Satellites, CirclesHoldThoughFixesErrAlike) {
  for (const bool wandering : {false, true}) {
    int n = 0, in68 = 0, in95 = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      const auto tracker = planned()->make_tracker(Random(seed));
      Random noise(seed + 100);
      BuildingPoint error = off({}, 5.0, noise);
      for (double t = 0.5; t <= 120.0; t += 0.5) {
        const BuildingPoint p{100.0 + kSpeedMps * t, 50.0};
        tracker->feed(step(t, 0.0));
        if (std::fmod(t, 1.0) != 0.0) continue;
        const double kept = wandering ? std::exp(-1.0 / 20.0) : 1.0;
        error = off({kept * error.x_m, kept * error.y_m}, 5.0 * std::sqrt(1.0 - kept * kept), noise);
        tracker->feed(fix_at({p.x_m + error.x_m, p.y_m + error.y_m}, 5.0, t));
        if (t < 20.0) continue;
        const FusedPosition now = position_at(*tracker, t);
        const double error_m = distance_m(now.place.point, p);
        ++n, in68 += error_m <= now.radius68_m, in95 += error_m <= now.radius95_m;
      }
    }
    EXPECT_GT(in68, 0.55 * n) << (wandering ? "wandering" : "the same all the time");
    EXPECT_GT(in95, 0.93 * n) << (wandering ? "wandering" : "the same all the time");
  }
}

// Round the block, indoors, while the receiver claims to be so far to the south; no fixes where sigma is 0.
struct Round {
  double error_m = 0.0;
  double doubtful = 0.0;           ///< share of the positions that are not `ok`
};
Round round_with_fixes(double off_m, double sigma_m) {
  Round round;
  int asked = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto tracker = planned()->make_tracker(Random(seed));
    for (double t = 0.5; t <= 60.0; t += 0.5) {
      const BuildingPoint a = around(kSpeedMps * (t - 0.5)), b = around(kSpeedMps * t);
      tracker->feed(step(t, std::atan2(b.y_m - a.y_m, b.x_m - a.x_m)));
      if (std::fmod(t, 2.0) == 0.0) tracker->feed(scan_at(b, 1, t));
      if (std::fmod(t, 1.0) == 0.0 && sigma_m > 0.0 && t > 10.0) tracker->feed(fix_at({b.x_m, b.y_m - off_m}, sigma_m, t));
      if (t < 20.0) continue;
      const FusedPosition now = position_at(*tracker, t);
      round.error_m += distance_m(now.place.point, b);
      round.doubtful += now.integrity != Integrity::kOk;
      ++asked;
    }
  }
  return {round.error_m / asked, round.doubtful / asked};
}

TEST(Satellites, TakeNoPhoneOutThatScansHoldIn) {
  const Round alone = round_with_fixes(0.0, 0.0);
  EXPECT_EQ(alone.doubtful, 0.0);
  for (const double off_m : {12.0, 25.0, 60.0}) {
    for (const double sigma_m : {5.0, 12.0}) {
      const Round round = round_with_fixes(off_m, sigma_m);
      EXPECT_LT(round.error_m, alone.error_m + 0.5) << off_m << " m off, said to be within " << sigma_m;
      if (off_m > 4.0 * sigma_m) { EXPECT_GT(round.doubtful, 0.95) << off_m << " m off, said to be within " << sigma_m; }
      if (off_m < 3.0 * sigma_m) { EXPECT_EQ(round.doubtful, 0.0) << off_m << " m off, said to be within " << sigma_m; }
    }
  }
  const auto tracker = planned()->make_tracker(Random(1));
  walk(*tracker, 0.0, 20.0, 0.0);
  for (const double t : {20.1, 20.2}) tracker->feed(fix_at({0.0, -60.0}, 5.0, t));
  EXPECT_THAT(tracker->doubts(PhoneTime(from_seconds(20.3))), testing::Contains(testing::HasSubstr("satellite fixes are far from")));
}

}  // namespace
}  // namespace wayfuse
