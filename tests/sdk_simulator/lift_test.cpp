#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "sdk/src/simulator/lift_profile.hpp"
#include "sdk/src/simulator/sensors.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

namespace wayfuse::simulator {
namespace {

// ---- the profile

TEST(LiftProfile, EndsWhereItShouldAtRestWithinItsLimits) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const LiftSettings lift{0.5 + 0.7 * random.uniform(), 1.0 + 1.5 * random.uniform(), 0.8 + 1.2 * random.uniform()};
    const double far_m = 0.3 + 60.0 * random.uniform() * random.uniform();
    const LiftProfile ride = LiftProfile::of(lift, far_m);
    constexpr double kStep_s = 1e-3;
    double speed_mps = 0.0, height_m = 0.0, before_mps2 = 0.0;
    for (double t = 0.0; t < ride.lasts_s(); t += kStep_s) {
      const double now_mps2 = ride.acceleration_mps2(t + 0.5 * kStep_s);
      ASSERT_LE(std::abs(now_mps2), lift.acceleration_mps2 + 1e-9);
      ASSERT_LE(std::abs(now_mps2 - before_mps2), lift.jerk_mps3 * kStep_s * 1.001 + 1e-9) << t;
      before_mps2 = now_mps2;
      height_m += kStep_s * (speed_mps + 0.5 * kStep_s * now_mps2);
      speed_mps += kStep_s * now_mps2;
      ASSERT_LE(speed_mps, lift.speed_mps + 0.01);
      ASSERT_NEAR(height_m, ride.travelled_m(t + kStep_s), 0.01) << far_m << " at " << t;   // its own integral
    }
    EXPECT_NEAR(height_m, far_m, 0.01);
    EXPECT_NEAR(speed_mps, 0.0, 0.01);
  }
}

// ---- and what a phone makes of it, without a barometer

struct Ridden {
  double from_s, until_s, rise_m;
};
std::vector<Ridden> rides_of(const Walker& walker) {
  std::vector<Ridden> rides;
  constexpr double kStep_s = 0.02;
  double begun_s = -1.0, from_m = 0.0, before_m = walker.at({}).height_m;
  for (double t = kStep_s; t < seconds(walker.length()); t += kStep_s) {
    const Truth truth = walker.at(from_seconds(t));
    const bool carried = std::abs(truth.height_m - before_m) > 1e-9 && truth.speed_mps < 1e-6;
    if (carried && begun_s < 0.0) {
      begun_s = t;
      from_m = before_m;
    }
    if (!carried && begun_s >= 0.0) {
      if (std::abs(truth.height_m - from_m) > 1.0) rides.push_back({begun_s, t, truth.height_m - from_m});
      begun_s = -1.0;
    }
    before_m = truth.height_m;
  }
  return rides;
}

struct Score {
  int rides = 0, told = 0, right = 0, right_storey = 0, false_rides = 0;
  double hours = 0.0;
  std::vector<double> errors_m;
};

// A quarter of an hour in an office tower with a phone drawn at random, carried that way.
void live(std::uint64_t seed, const CarryingSettings& carrying, Score& score) {
  Random random(seed);
  WorldSettings tower;
  tower.floors = 3 + static_cast<int>(seed % 10);
  const World world = make_world(tower, random);
  const Walker walker(world, {}, std::chrono::minutes(15), {}, random);
  Device device = draw_device(random);
  device.barometer = false;
  MotionSensors sensors(world, walker, device, carrying, random.split());
  MotionTracker motion = std::move(MotionTracker::create({})).value();
  std::vector<LiftRide> told;
  for (double t = 0.0; t < seconds(walker.length()); t += 1.0 / device.rate_hz) {
    motion.feed(sensors.sample(from_seconds(t), PhoneTime{from_seconds(t)}));
    const auto lift = motion.walk().lift;
    if (lift && !lift->under_way && (told.empty() || told.back().end != lift->end)) told.push_back(*lift);
  }
  const std::vector<Ridden> rides = rides_of(walker);
  score.rides += static_cast<int>(rides.size());
  score.hours += seconds(walker.length()) / 3600.0;
  for (const LiftRide& lift : told) {
    const auto ridden = std::find_if(rides.begin(), rides.end(), [&](const Ridden& r) {
      return seconds(lift.start.time_since_epoch()) < r.until_s && seconds(lift.end.time_since_epoch()) > r.from_s;
    });
    if (ridden == rides.end()) {
      ++score.false_rides;
      continue;
    }
    ++score.told;
    score.right += lift.rise_m * ridden->rise_m > 0.0;
    score.right_storey += std::lround(lift.rise_m / world.storey_m) == std::lround(ridden->rise_m / world.storey_m);
    score.errors_m.push_back(std::abs(lift.rise_m - ridden->rise_m));
  }
}

Score score_of(int seeds, Duration stay, double fidgets_per_min) {
  Score score;
  for (int seed = 1; seed <= seeds; ++seed) {
    CarryingSettings carrying;
    carrying.mode = static_cast<Carrying>(seed % kCarryingModes);
    carrying.stay = stay;
    carrying.fidgets_per_min = fidgets_per_min;
    live(static_cast<std::uint64_t>(seed), carrying, score);
  }
  std::sort(score.errors_m.begin(), score.errors_m.end());
  if (std::getenv("WAYFUSE_SHOW")) {
    std::printf("stay %.0f s, %.1f fidgets a minute: %.1f h, %d rides, %d told, %d in the right direction, %d by the right storeys, %d false; error median %.2f p90 %.2f m\n",
                seconds(stay), fidgets_per_min, score.hours, score.rides, score.told, score.right, score.right_storey, score.false_rides,
                score.errors_m[score.errors_m.size() / 2], score.errors_m[score.errors_m.size() * 9 / 10]);
  }
  return score;
}

int seeds() {
  const char* asked = std::getenv("WAYFUSE_LIFT_SEEDS");
  return asked ? std::atoi(asked) : 16;
}

TEST(LiftRides, ArePickedUpFromTheAccelerationAlone) {
  const Score score = score_of(seeds(), Duration{0}, 0.0);
  EXPECT_GE(score.rides, 3 * seeds());
  EXPECT_GE(score.told, std::ceil(0.95 * score.rides));
  EXPECT_GE(score.right, std::ceil(0.99 * score.told));
  EXPECT_GE(score.right_storey, std::ceil(0.95 * score.told));
  EXPECT_EQ(score.false_rides, 0) << "in " << score.hours << " h";
}

// Phones that go from hand to ear to pocket, and people who crouch, raise the phone and knock against things: rides may be
// overlooked then, but none is made up.
TEST(LiftRides, AreNeverMadeUp) {
  const Score score = score_of(seeds(), std::chrono::seconds(40), 2.0);
  EXPECT_GE(score.told, 0.4 * score.rides);
  EXPECT_GE(score.right, std::ceil(0.99 * score.told));
  EXPECT_LT(score.false_rides / score.hours, 1.0);
}

}  // namespace
}  // namespace wayfuse::simulator
