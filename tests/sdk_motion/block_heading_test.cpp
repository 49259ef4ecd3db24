#include "sdk/src/attitude/block_heading.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <type_traits>

#include "tests/sdk_motion/still_phone.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

static_assert(std::is_trivially_copyable_v<BlockHeadingState>, "saved and restored as plain bytes");

double apart_deg(Quaternion a, Quaternion b) {
  const Quaternion d = conjugate(a) * b;
  return 2.0 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::abs(d.w)) / kDegree;
}

// A phone tumbled by hand about all axes, from `start_s` on; before that it lies still.
Quaternion tumbling(double t, double start_s = 0.0) {
  const double s = std::max(0.0, t - start_s);
  return held(40 * std::sin(0.9 * s) + 20 * s, 50 * std::sin(0.7 * s), 60 * std::sin(1.1 * s));
}

// What the sensors say there, the gyroscope by the difference of attitudes half a millisecond around.
template <typename Path>
MargSample sense_along(Path path, double t) {
  constexpr double h = 5e-4;
  const Quaternion d = conjugate(path(t - h)) * path(t + h);
  const double sign = d.w < 0 ? -1.0 : 1.0;
  return sense(t, path(t), Vector3{d.x, d.y, d.z} * (sign / h));
}

BlockHeading exact() {
  BlockHeadingSettings settings;
  settings.sensor_delay_s = 0.0;  // the simulated gyroscope answers at once
  return BlockHeading(settings);
}

TEST(BlockHeading, FollowsATumblingPhoneAtAnyRate) {
  for (const double rate_hz : {25.0, 50.0, 100.0, 200.0, 400.0}) {
    BlockHeading estimator = exact();
    const auto path = [](double t) { return tumbling(t); };
    double worst = 0.0;
    for (int i = 0; i < 30 * rate_hz; ++i) {
      const double t = i / rate_hz;
      estimator.feed(sense_along(path, t));
      if (t > 5.0) worst = std::max(worst, apart_deg(path(t), estimator.attitude()->body_to_enu));
    }
    EXPECT_LT(worst, rate_hz < 40 ? 1.5 : 0.6) << rate_hz << " Hz";
  }
}

TEST(BlockHeading, TakesTimestampsAsTheyAre) {
  BlockHeading estimator = exact();
  Random random(1);
  const auto path = [](double t) { return tumbling(t); };
  double t = 0.0, worst = 0.0;
  while (t < 30.0) {
    t += 0.002 + 0.016 * random.uniform();  // 2 to 18 ms apart
    estimator.feed(sense_along(path, t));
    if (t > 5.0) worst = std::max(worst, apart_deg(path(t), estimator.attitude()->body_to_enu));
  }
  EXPECT_LT(worst, 0.6);
}

TEST(BlockHeading, SensorsMaySpeakOneByOne) {
  BlockHeading estimator = exact();
  const auto path = [](double t) { return tumbling(t); };
  double worst = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const double t = i * 0.01;
    MargSample rate = sense_along(path, t), force = sense_along(path, t + 0.003), field = sense_along(path, t + 0.006);
    rate.acceleration_mps2.reset();
    rate.field_ut.reset();
    force.turn_rate_radps.reset();
    force.field_ut.reset();
    field.turn_rate_radps.reset();
    field.acceleration_mps2.reset();
    estimator.feed(rate);
    if (t > 5.0) worst = std::max(worst, apart_deg(path(t), estimator.attitude()->body_to_enu));
    estimator.feed(force);
    estimator.feed(field);
  }
  EXPECT_LT(worst, 1.5);
}

TEST(BlockHeading, LearnsTheGyroscopesBiasAtRestAndHandsItOn) {
  BlockHeading estimator;
  const Vector3 bias{0.006, -0.004, 0.003};
  for (int i = 0; i < 2000; ++i) estimator.feed(sense(i * 0.01, held(10), bias));
  const SensorCalibration learnt = *estimator.calibration();
  EXPECT_LT(norm(learnt.turn_rate_bias_radps - bias), 2e-4);
  EXPECT_TRUE(estimator.attitude()->at_rest);
  EXPECT_LT(norm(estimator.attitude()->turn_rate_radps), 2e-4);

  BlockHeading next;
  next.start_with(learnt);
  next.feed(sense(0.0, held(10), bias));
  EXPECT_LT(norm(next.attitude()->turn_rate_radps), 2e-4);
}

TEST(BlockHeading, LearnsTheBiasInMotion) {
  BlockHeading estimator = exact();
  const Vector3 bias{0.004, -0.003, 0.0};
  const auto path = [](double t) { return tumbling(t); };
  for (int i = 0; i < 12000; ++i) {
    MargSample sample = sense_along(path, i * 0.01);
    *sample.turn_rate_radps = *sample.turn_rate_radps + bias;
    estimator.feed(sample);
  }
  EXPECT_FALSE(estimator.attitude()->at_rest);
  EXPECT_LT(norm(estimator.calibration()->turn_rate_bias_radps - bias), 0.002);
}

TEST(BlockHeading, AnAttachedMagnetIsFoundAndTakenOut) {
  BlockHeading estimator = exact();
  const Vector3 magnet{8, -6, 15};
  const auto path = [](double t) { return tumbling(t, 15.0); };
  double worst = 0.0;
  for (int i = 0; i < 9000; ++i) {
    const double t = i * 0.01;
    MargSample sample = sense_along(path, t);
    if (t > 10.0) *sample.field_ut = *sample.field_ut + magnet;  // clipped on while the phone lies still
    estimator.feed(sample);
    if (t > 40.0) worst = std::max(worst, apart_deg(path(t), estimator.attitude()->body_to_enu));
  }
  EXPECT_LT(norm(estimator.calibration()->field_offset_ut - magnet), 0.5);
  EXPECT_LT(worst, 2.0);
}

TEST(BlockHeading, AMagnetThereFromTheStartIsTakenOutOfThePast) {
  BlockHeading estimator = exact();
  const Vector3 magnet{8, -6, 5};
  const auto path = [](double t) { return tumbling(t, 15.0); };
  double before = 0.0, after = 0.0;
  for (int i = 0; i < 4500; ++i) {
    const double t = i * 0.01;
    MargSample sample = sense_along(path, t);
    *sample.field_ut = *sample.field_ut + magnet;
    estimator.feed(sample);
    if (i == 1400) before = apart_deg(path(t), estimator.attitude()->body_to_enu);
    after = apart_deg(path(t), estimator.attitude()->body_to_enu);
  }
  EXPECT_GT(before, 8.0);  // lying still nobody can know
  EXPECT_LT(after, 2.0);   // seconds after the phone was first turned about: the whole average is corrected at once
}

TEST(BlockHeading, APassingMagnetTurnsNothing) {
  BlockHeading estimator = exact();
  double worst = 0.0, quality = 1.0, sigma_before = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double t = i * 0.01;
    MargSample sample = sense(t, held(77));
    if (t > 20 && t < 30) *sample.field_ut = *sample.field_ut + Vector3{25, 10, 0};
    estimator.feed(sample);
    if (i == 2000) sigma_before = estimator.attitude()->heading_sigma_rad;
    if (t > 20) worst = std::max(worst, apart_deg(held(77), estimator.attitude()->body_to_enu));
    if (i == 2900) {
      quality = estimator.attitude()->magnetic_quality;
      EXPECT_GT(estimator.attitude()->heading_sigma_rad, sigma_before);
    }
  }
  EXPECT_LT(worst, 2.0);
  EXPECT_LT(quality, 0.3);
}

TEST(BlockHeading, WithoutACompassTheHeadingIsRelativeAndLevelStays) {
  BlockHeading estimator = exact();
  const auto path = [](double t) { return tumbling(t); };
  std::optional<double> offset;
  for (int i = 0; i < 3000; ++i) {
    MargSample sample = sense_along(path, i * 0.01);
    sample.field_ut.reset();
    estimator.feed(sample);
    const Attitude attitude = *estimator.attitude();
    EXPECT_EQ(attitude.reference, HeadingReference::kArbitrary);
    EXPECT_EQ(attitude.body_to_enu, attitude.body_to_level);
    const Quaternion d = attitude.body_to_enu * conjugate(path(i * 0.01));
    const double yaw = 2.0 * std::atan2(d.z, d.w);
    if (i == 500) offset = yaw;
    if (offset) {
      EXPECT_LT(std::abs(wrap_angle_rad(yaw - *offset)), 1.0 * kDegree);
    }
  }
}

TEST(BlockHeading, GravityAndCompassCarryOnWhileTheGyroscopeIsSilent) {
  BlockHeading estimator = exact();
  const auto path = [](double t) { return held(90 * std::sin(0.3 * t), 20 * std::sin(0.4 * t), 15 * std::sin(0.2 * t)); };
  double silent = 0.0, after = 0.0, sigma = 0.0;
  for (int i = 0; i < 6000; ++i) {
    const double t = i * 0.01;
    MargSample sample = sense_along(path, t);
    if (t > 20 && t < 40) sample.turn_rate_radps.reset();
    estimator.feed(sample);
    const double error = apart_deg(path(t), estimator.attitude()->body_to_enu);
    if (t > 21 && t < 40) silent = std::max(silent, error);
    if (t > 41) after = std::max(after, error);
    if (i == 3500) sigma = estimator.attitude()->heading_sigma_rad;
  }
  EXPECT_LT(silent, 12.0);  // 27 degrees a second, smoothed over 0.3 s: 8 degrees behind, and a little for the tilt
  EXPECT_GT(sigma, 0.3);
  EXPECT_LT(after, 1.0);
}

TEST(BlockHeading, APhoneWithoutAGyroscopeStillHasAHeading) {
  BlockHeading estimator;
  for (int i = 0; i < 1000; ++i) {
    MargSample sample = sense(i * 0.02, held(i < 500 ? 30 : 120, 20));
    sample.turn_rate_radps.reset();
    estimator.feed(sample);
  }
  EXPECT_LT(apart_deg(held(120, 20), estimator.attitude()->body_to_enu), 1.0);
}

TEST(BlockHeading, SensorsThatSpeakApartAreBroughtToOneTime) {
  BlockHeading estimator = exact();
  const Vector3 turning{0, 0, 3.0};
  for (int i = 0; i < 200; ++i) {
    MargSample rate = sense(i * 0.02, about_up(3.0 * i * 0.02), turning), force;
    rate.field_ut.reset();
    estimator.feed(rate);
    force.time = rate.time + std::chrono::milliseconds(10);
    force.acceleration_mps2 = Vector3{0, 0, 9.81};
    estimator.feed(force);
  }
  // The last gravity came 10 ms after the last turn rate, and the phone has turned 0.03 rad since.
  const Quaternion d = about_up(3.0 * 199 * 0.02);
  EXPECT_NEAR(apart_deg(d, estimator.attitude()->body_to_enu), 0.03 / kDegree, 0.01);
}

TEST(BlockHeading, SavedAndRestoredItGoesOnBitForBit) {
  BlockHeading estimator, restored;
  const auto path = [](double t) { return tumbling(t, 3.0); };
  for (int i = 0; i < 1000; ++i) estimator.feed(sense_along(path, i * 0.01));
  const BlockHeadingState saved = estimator.state();
  restored.restore(saved);
  for (int i = 1000; i < 2000; ++i) {
    const MargSample sample = sense_along(path, i * 0.01);
    estimator.feed(sample);
    restored.feed(sample);
    ASSERT_EQ(estimator.attitude()->body_to_enu, restored.attitude()->body_to_enu);
  }
}

TEST(BlockHeading, ItsSigmaHoldsUnderNoise) {
  Random random(7);
  int inside = 0, total = 0;
  for (int run = 0; run < 30; ++run) {
    BlockHeading estimator = exact();
    const Vector3 bias{0.002 * random.normal(), 0.002 * random.normal(), 0.002 * random.normal()};
    const auto path = [](double t) { return tumbling(t); };
    for (int i = 0; i < 2000; ++i) {
      MargSample sample = sense_along(path, i * 0.02);
      const auto noise = [&](double sigma) { return Vector3{sigma * random.normal(), sigma * random.normal(), sigma * random.normal()}; };
      *sample.turn_rate_radps = *sample.turn_rate_radps + bias + noise(0.005);
      *sample.acceleration_mps2 = *sample.acceleration_mps2 + noise(0.3);
      *sample.field_ut = *sample.field_ut + noise(1.0);
      estimator.feed(sample);
    }
    const Quaternion d = estimator.attitude()->body_to_enu * conjugate(path(1999 * 0.02));
    inside += 2.0 * std::abs(std::atan2(d.z, d.w)) < 2.0 * estimator.attitude()->heading_sigma_rad;
    ++total;
  }
  EXPECT_GE(inside, total * 0.8);
}

TEST(BlockHeading, ClippedAndBrokenReadingsAreCountedAndPassedOver) {
  BlockHeading estimator = exact();
  const auto path = [](double t) { return tumbling(t); };
  for (int i = 0; i < 2000; ++i) {
    MargSample sample = sense_along(path, i * 0.01);
    if (i % 50 == 7) sample.turn_rate_radps = Vector3{1000, 0, 0};
    if (i % 50 == 17) sample.acceleration_mps2 = Vector3{0, std::numeric_limits<double>::quiet_NaN(), 0};
    estimator.feed(sample);
  }
  EXPECT_LT(apart_deg(path(19.99), estimator.attitude()->body_to_enu), 2.0);
  EXPECT_EQ(estimator.counts().overrange, 40u);
  EXPECT_EQ(estimator.counts().not_finite, 40u);
}

}  // namespace
}  // namespace wayfuse
