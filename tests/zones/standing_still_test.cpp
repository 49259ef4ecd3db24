#include <gtest/gtest.h>

#include <cmath>

#include "server/zones/zone_watch.hpp"
#include "tests/fixtures/scratch_folder.hpp"
#include "tests/fixtures/still_clock.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

constexpr int kHour_s = 3600;
constexpr int kEvery_s = 2;

/// How a phone's position errs while it stands: normal, of the size the position itself states, wandering over `memory_s`
/// (an Ornstein-Uhlenbeck process, as single scans of the recorded malls err: correlation 0.5 after 6 s, 0.2 after 20 s).
struct Jitter {
  double sigma_m = 3.0;
  double memory_s = 10.0;
  double stated_sigma_m = 3.0;
};

struct Flaps {
  int naive = 0;      ///< crossings of the zone's edge by the position itself
  int told = 0;       ///< transitions after the first, which finds out where the phone is
};

/// An hour beside the edge of a room of 20 m, `outside_m` from it.
Flaps stand(double outside_m, const Jitter& jitter, std::uint64_t seed) {
  static ScratchFolder folder;
  static const auto store = [] {
    DatabaseDirectory::Options options;
    options.own_thread = false;
    return *DatabaseDirectory::open(folder.path(), options);
  }();
  StillClock clock;
  ZoneWatch watch(*store, clock, 1, ZoneRules{});
  ZoneRecord room;
  room.id = 1;
  room.name = "Room";
  room.region = {{{{0, 0}, {20, 0}, {20, 20}, {0, 20}}}};
  watch.put_zones({1}, {room});
  Random random(seed);
  const double keep = std::exp(-kEvery_s / jitter.memory_s);
  const double fresh = jitter.sigma_m * std::sqrt(1 - keep * keep);
  double x = jitter.sigma_m * random.normal();
  double y = jitter.sigma_m * random.normal();
  Flaps flaps;
  bool was_in = false;
  for (int t = 0; t < kHour_s; t += kEvery_s) {
    x = keep * x + fresh * random.normal();
    y = keep * y + fresh * random.normal();
    FusedPosition position;
    position.valid_at = PhoneTime(std::chrono::seconds(t));
    position.building = {1};
    position.place = {{-outside_m + x, 10 + y}, {0}};
    position.covariance = {jitter.stated_sigma_m * jitter.stated_sigma_m, 0, jitter.stated_sigma_m * jitter.stated_sigma_m};
    position.radius95_m = 2.45 * jitter.stated_sigma_m;
    clock.advance(std::chrono::seconds(kEvery_s));
    watch.moved("phone", position);
    watch.tick();
    const bool in = position.place.point.x_m >= 0;
    flaps.naive += t > 0 && in != was_in;
    was_in = in;
  }
  flaps.told = std::max<int>(0, static_cast<int>(watch.newest_event()) - 1);
  return flaps;
}

TEST(StandingStill, CrossesNoBoundaryInAnHourWhereverItStands) {
  int naive = 0;
  for (const double outside_m : {-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Flaps flaps = stand(outside_m, {}, seed);
      EXPECT_EQ(flaps.told, 0) << outside_m << " m outside, seed " << seed;
      naive += flaps.naive;
    }
  }
  EXPECT_GT(naive, 140 * 100) << "the same positions taken at their word flap a hundred times an hour";
}

TEST(StandingStill, HoldsForSlowFastAndBadlyStatedErrors) {
  for (const Jitter& jitter : {Jitter{3, 2, 3}, Jitter{3, 20, 3}, Jitter{6, 10, 6}, Jitter{1, 10, 1}, Jitter{4, 10, 2}}) {
    for (const double outside_m : {-1.0, 0.0, 1.0}) {
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        EXPECT_EQ(stand(outside_m, jitter, seed).told, 0)
            << outside_m << " m outside, sigma " << jitter.sigma_m << " stated " << jitter.stated_sigma_m << ", memory " << jitter.memory_s;
      }
    }
  }
}

}  // namespace
}  // namespace wayfuse
