#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <numbers>
#include <string>

#include "sdk/src/attitude/block_heading.hpp"
#include "tests/sdk_motion/still_phone.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

namespace {
std::atomic<long> g_allocations{0};
}

// Every allocation of this test program is counted: the core loop must make none.
void* operator new(std::size_t size) {
  ++g_allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace wayfuse {
namespace {

Vector3 anything(Random& random, double scale) {
  const double pick = random.uniform();
  if (pick < 0.01) return {std::numeric_limits<double>::quiet_NaN(), 0, 0};
  if (pick < 0.02) return {0, std::numeric_limits<double>::infinity(), 0};
  if (pick < 0.03) return {0, 0, 0};
  if (pick < 0.04) return Vector3{random.normal(), random.normal(), random.normal()} * (1e6 * scale);
  return Vector3{random.normal(), random.normal(), random.normal()} * scale;
}

bool sound(const Quaternion& q) {
  const double square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return std::abs(square - 1.0) < 1e-9;
}

TEST(Endurance, NothingASensorSaysBreaksTheTracker) {
  for (const std::string& name : heading_estimator_names()) {
    Random random(11);
    MotionTrackerSettings settings;
    settings.heading_estimator = name;
    MotionTracker phone = std::move(MotionTracker::create(settings)).value();
    double t = 0.0;
    for (int i = 0; i < 50000; ++i) {
      t += random.uniform() < 0.001 ? 100.0 * random.uniform() : 0.04 * random.uniform() - 0.002;
      MargSample sample;
      sample.time = PhoneTime{from_seconds(t)};
      if (random.uniform() < 0.8) sample.acceleration_mps2 = anything(random, 9.0);
      if (random.uniform() < 0.8) sample.turn_rate_radps = anything(random, 3.0);
      if (random.uniform() < 0.8) sample.field_ut = anything(random, 40.0);
      if (random.uniform() < 0.1) sample.pressure_hpa = 1000.0 * random.normal();
      if (const auto report = phone.feed(sample)) {
        ASSERT_TRUE(std::isfinite(report->heading.radians())) << name;
        ASSERT_TRUE(report->heading_sigma_rad >= 0.0 && report->heading_sigma_rad <= std::numbers::pi) << name;
        ASSERT_TRUE(report->distance_m() >= 0.0 && report->distance_m() < 50.0) << name;
        ASSERT_TRUE(std::isfinite(report->distance_sigma_m)) << name;
        ASSERT_TRUE(report->interval >= Duration{0} && report->interval <= std::chrono::seconds(60)) << name;
        ASSERT_TRUE(!report->climb_m || std::isfinite(*report->climb_m)) << name;
      }
      const auto attitude = phone.attitude();
      ASSERT_TRUE(!attitude || sound(attitude->body_to_enu)) << name << " " << i;
    }
  }
}

// Hours in a bag: turning, walking, lying. The covariance stays one, and the bias within its bounds.
TEST(Endurance, HoursLeaveTheFilterSound) {
  BlockHeading estimator;
  Random random(5);
  for (int i = 0; i < 3600 * 25; ++i) {
    const double t = i * 0.04, active = std::fmod(t, 120.0) < 60.0 ? 1.0 : 0.0;
    MargSample sample = sense(t, held(30 * active * std::sin(t), 20 * active * std::sin(0.7 * t), 10 * active * std::cos(0.3 * t)));
    *sample.turn_rate_radps = *sample.turn_rate_radps + Vector3{random.normal(), random.normal(), random.normal()} * 0.01;
    *sample.acceleration_mps2 = *sample.acceleration_mps2 + Vector3{random.normal(), random.normal(), random.normal()} * (0.05 + 2 * active);
    estimator.feed(sample);
  }
  const InertialKalman& kalman = estimator.state().kalman;
  for (int i = 0; i < InertialKalman::kStates; ++i) {
    EXPECT_GT(kalman.p[i][i], 0.0);
    for (int j = 0; j < i; ++j) {
      EXPECT_NEAR(kalman.p[i][j], kalman.p[j][i], 1e-12);
      EXPECT_LE(kalman.p[i][j] * kalman.p[i][j], kalman.p[i][i] * kalman.p[j][j] * 1.000001);
    }
  }
  EXPECT_TRUE(sound(estimator.attitude()->body_to_enu));
}

TEST(Endurance, FeedingAllocatesNothing) {
  MotionTracker phone = std::move(MotionTracker::create({})).value();
  long steps = 0;
  const long before = g_allocations;
  for (int i = 0; i < 5000; ++i) {
    MargSample sample = sense(i * 0.02, held(90));
    sample.acceleration_mps2 = Vector3{0, 0, 9.81 + 4.0 * std::sin(2 * std::numbers::pi * 2.0 * i * 0.02)};
    if (const auto report = phone.feed(sample)) steps += report->steps;
  }
  EXPECT_EQ(g_allocations - before, 0);
  EXPECT_GT(steps, 150);
}

}  // namespace
}  // namespace wayfuse
