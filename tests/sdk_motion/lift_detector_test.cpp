#include "sdk/src/walking/lift_detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/sdk_motion/still_phone.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

namespace wayfuse {
namespace {

constexpr double kRate_hz = 50.0;

// A ride from rest to rest in trapezoids of acceleration: half a second up, plateau, half a second down; the same backwards.
struct Ride {
  double acceleration_mps2 = 0.8, speed_mps = 1.6, rise_m = 7.0, starts_s = 10.0;

  double pulse_s() const { return top_mps() / acceleration_mps2 + kRamp_s; }
  // v (v / a + ramp) is what speeding up and slowing down take of the way.
  double top_mps() const {
    const double a = acceleration_mps2, half = 0.5 * a * kRamp_s;
    return std::min(speed_mps, std::sqrt(half * half + a * std::abs(rise_m)) - half);
  }
  double lasts_s() const { return std::abs(rise_m) / top_mps() + pulse_s(); }
  double felt_mps2(double t_s) const {
    const auto pulse = [this](double at_s) { return std::clamp(std::min(at_s, pulse_s() - at_s) / kRamp_s, 0.0, 1.0); };
    const double since_s = t_s - starts_s;
    return std::copysign(acceleration_mps2, rise_m) * (pulse(since_s) - pulse(lasts_s() - since_s));
  }
  static constexpr double kRamp_s = 0.5;
};

// Smoothly from one height to another, as hands and knees do.
double moved_mps2(double t_s, double at_s, double rise_m, double lasting_s) {
  const double t = (t_s - at_s) / lasting_s;
  return t > 0.0 && t < 1.0 ? rise_m / (lasting_s * lasting_s) * 60.0 * t * (1.0 + t * (2.0 * t - 3.0)) : 0.0;
}

/// A phone whose accelerometer errs and rustles, in a hand that wavers.
struct Phone {
  explicit Phone(std::uint64_t seed) : random(seed) {
    bias = Vector3{random.normal(), random.normal(), random.normal()} * 0.15;
    phase = 6.28 * random.uniform();
  }
  MargSample feel(double t_s, Quaternion attitude, double up_mps2) {
    MargSample sample = sense(t_s, attitude);
    const double sway = 0.05 * std::sin(4.0 * t_s + phase) + 0.03 * std::sin(1.7 * t_s);
    const Vector3 noise{0.08 * random.normal(), 0.08 * random.normal(), 0.08 * random.normal()};
    sample.acceleration_mps2 = unrotate(attitude, {0, 0, 9.81 + up_mps2 + sway}) + bias + noise;
    return sample;
  }
  Random random;
  Vector3 bias;
  double phase;
};

MotionTracker tracker() { return std::move(MotionTracker::create({})).value(); }

std::optional<LiftRide> felt(const Ride& ride, Phone& phone) {
  MotionTracker motion = tracker();
  for (double t = 0.0; t < ride.starts_s + ride.lasts_s() + 4.0; t += 1.0 / kRate_hz) {
    motion.feed(phone.feel(t, held(30, 35), ride.felt_mps2(t)));
  }
  return motion.walk().lift;
}

TEST(LiftDetector, TellsRidesWithTheirDirectionAndHeight) {
  int told = 0, right = 0, within = 0, within_two = 0;
  std::vector<double> errors_m;
  constexpr int kRides = 400;
  for (int seed = 0; seed < kRides; ++seed) {
    Phone phone(static_cast<std::uint64_t>(seed + 1));
    Ride ride;
    ride.acceleration_mps2 = 0.5 + 0.7 * phone.random.uniform();
    ride.speed_mps = 1.0 + 1.5 * phone.random.uniform();
    ride.rise_m = (phone.random.uniform() < 0.5 ? -1.0 : 1.0) * (3.0 + 37.0 * phone.random.uniform() * phone.random.uniform());
    const auto lift = felt(ride, phone);
    if (!lift || lift->under_way) continue;
    ++told;
    right += lift->rise_m * ride.rise_m > 0.0;
    const double error_m = std::abs(lift->rise_m - ride.rise_m);
    errors_m.push_back(error_m);
    within += error_m < lift->rise_sigma_m;
    within_two += error_m < 2.0 * lift->rise_sigma_m;
    EXPECT_NEAR(seconds(lift->start.time_since_epoch()), ride.starts_s, 1.0) << seed;
    EXPECT_NEAR(seconds(lift->end.time_since_epoch()), ride.starts_s + ride.lasts_s(), 1.0) << seed;
  }
  std::sort(errors_m.begin(), errors_m.end());
  RecordProperty("told", told);
  RecordProperty("median_error_cm", static_cast<int>(100.0 * errors_m[errors_m.size() / 2]));
  EXPECT_GE(told, kRides * 95 / 100);
  EXPECT_GE(right, told * 99 / 100);
  EXPECT_LT(errors_m[errors_m.size() / 2], 0.5);
  EXPECT_GT(within, told * 60 / 100);       // an honest sigma: 68 %,
  EXPECT_GT(within_two, told * 90 / 100);   // 95 %
}

// Everything people do with a phone while they stand about, three times a minute for an hour: no ride.
TEST(LiftDetector, HandsKneesAndKnocksAreNoLift) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Phone phone(seed);
    MotionTracker motion = tracker();
    double event_s = 5.0, rise_m = 0.0, lasting_s = 1.0, back_s = 7.0, knock_mps2 = 0.0, pitch_deg = 35.0, pitch_to_deg = 35.0;
    for (double t = 0.0; t < 900.0; t += 1.0 / kRate_hz) {
      if (t > back_s + lasting_s) {
        event_s = t + 2.0 + 30.0 * phone.random.uniform();
        lasting_s = 0.5 + 2.0 * phone.random.uniform();
        rise_m = (phone.random.uniform() < 0.5 ? -1.0 : 1.0) * (0.05 + 0.75 * phone.random.uniform());
        knock_mps2 = phone.random.uniform() < 0.3 ? 15.0 : 0.0;
        back_s = event_s + lasting_s + 6.0 * phone.random.uniform();
        pitch_deg = pitch_to_deg;
        if (phone.random.uniform() < 0.5) pitch_to_deg = 140.0 * phone.random.uniform() - 60.0;
      }
      const double turned = std::clamp((t - event_s) / lasting_s, 0.0, 1.0);
      double up = moved_mps2(t, event_s, rise_m, lasting_s) + moved_mps2(t, back_s, -rise_m, lasting_s);
      if (t > event_s && t < event_s + 0.1) up += knock_mps2 * std::sin(2 * std::numbers::pi * 10.0 * (t - event_s));
      const double pitch = pitch_deg + turned * (pitch_to_deg - pitch_deg);
      MargSample sample = phone.feel(t, held(30, pitch), up);
      if (turned > 0.0 && turned < 1.0) sample.turn_rate_radps = Vector3{(pitch_to_deg - pitch_deg) * kDegree / lasting_s, 0, 0};
      motion.feed(sample);
      ASSERT_FALSE(motion.walk().lift) << seed << " at " << t << " s";
    }
  }
}

TEST(LiftDetector, WalkersAreInNoLift) {
  Phone phone(3);
  MotionTracker motion = tracker();
  for (double t = 0.0; t < 900.0; t += 1.0 / kRate_hz) {
    const double swing = std::fmod(t, 20.0) < 14.0 ? 2.0 + std::fmod(t / 20.0, 2.0) : 0.0;   // walks, and stops now and then
    motion.feed(phone.feel(t, held(30, 35), swing * std::sin(2 * std::numbers::pi * 1.9 * t)));
    ASSERT_FALSE(motion.walk().lift) << t;
  }
}

TEST(LiftDetector, ReportsTheRideOnceAndNoRestOnTheWay) {
  Phone phone(5);
  MotionTracker motion = tracker();
  Ride ride;
  double climbed_m = 0.0;
  int reports = 0, at_rest_on_the_way = 0;
  bool lift = false;
  for (double t = 0.0; t < 30.0; t += 1.0 / kRate_hz) {
    const auto report = motion.feed(phone.feel(t, held(30, 35), ride.felt_mps2(t)));
    const auto walk = motion.walk();
    lift = lift || (walk.climbing == Climbing::kLift && walk.lift->under_way);
    if (!report) continue;
    at_rest_on_the_way += report->at_rest && walk.lift && walk.lift->under_way;
    if (!report->climb_m) continue;
    ++reports;
    climbed_m += *report->climb_m;
  }
  EXPECT_TRUE(lift);
  EXPECT_EQ(reports, 1);
  EXPECT_NEAR(climbed_m, ride.rise_m, 1.0);
  EXPECT_EQ(at_rest_on_the_way, 0);
  EXPECT_EQ(motion.walk().climbing, Climbing::kNone);
}

// With a barometer its height goes out, and what it did not see did not happen.
TEST(LiftDetector, ABarometerConfirmsOrDenies) {
  for (const bool rises : {true, false}) {
    Phone phone(6);
    MotionTracker motion = tracker();
    Ride ride;
    double climbed_m = 0.0, speed_mps = 0.0, height_m = 0.0;
    for (double t = 0.0; t < 30.0; t += 1.0 / kRate_hz) {
      speed_mps += ride.felt_mps2(t) / kRate_hz;
      height_m += speed_mps / kRate_hz;
      MargSample sample = phone.feel(t, held(30, 35), ride.felt_mps2(t));
      sample.pressure_hpa = 1000.0 - (rises ? height_m : 0.0) / 8.4 + 0.01 * phone.random.normal();
      if (const auto report = motion.feed(sample)) climbed_m += report->climb_m.value_or(0.0);
    }
    EXPECT_EQ(motion.walk().lift.has_value(), rises);
    EXPECT_NEAR(climbed_m, rises ? ride.rise_m : 0.0, 0.3);   // of the barometer alone: nothing counts twice
    if (rises) {
      EXPECT_NEAR(motion.walk().lift->rise_m, ride.rise_m, 0.6);
      EXPECT_LT(motion.walk().lift->rise_sigma_m, 0.5);
    }
  }
}

TEST(LiftDetector, ACopyGoesOnToTheSameBits) {
  const Ride ride;
  const LiftDetectorSettings settings;
  Random random(9);
  LiftDetector first;
  std::optional<LiftDetector> copy;
  for (int i = 0; i < 1500; ++i) {
    const double t = i / kRate_hz;
    LiftDetector::Felt now{PhoneTime{from_seconds(t)}, 1.0 / kRate_hz, 9.81 + ride.felt_mps2(t) + 0.05 * random.normal(), {0, 0, 1}, {}, {}};
    first.feed(settings, now);
    if (copy) copy->feed(settings, now);
    if (i == 650) copy = first;   // in the middle of the ride
  }
  ASSERT_TRUE(first.ride());
  EXPECT_FALSE(first.riding());
  EXPECT_EQ(first.ride(), copy->ride());
  EXPECT_EQ(first.take(), copy->take());
  EXPECT_EQ(first.take(), std::nullopt);
}

TEST(LiftDetector, AHoleInTheReadingsEndsARide) {
  const LiftDetectorSettings settings;
  Ride ride;
  ride.rise_m = 20.0;
  LiftDetector detector;
  for (int i = 0; i < 800; ++i) {
    const double t = i / kRate_hz;
    detector.feed(settings, {PhoneTime{from_seconds(t)}, 1.0 / kRate_hz, 9.81 + ride.felt_mps2(t), {0, 0, 1}, {}, {}});
  }
  ASSERT_TRUE(detector.riding());
  EXPECT_GT(detector.ride()->rise_sigma_m, 0.2);
  detector.feed(settings, {PhoneTime{from_seconds(20.0)}, 4.0, 9.81, {0, 0, 1}, {}, {}});
  EXPECT_FALSE(detector.ride());
}

}  // namespace
}  // namespace wayfuse
