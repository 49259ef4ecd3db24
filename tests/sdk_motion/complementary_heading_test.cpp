#include "sdk/src/attitude/complementary_heading.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "sdk/src/attitude/catalogue.hpp"
#include "tests/sdk_motion/still_phone.hpp"

namespace wayfuse {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double azimuth_deg(const HeadingEstimator& estimator) { return estimator.attitude()->heading.azimuth_rad() / kDegree; }

double angle_between_deg(Quaternion a, Quaternion b) {
  const Quaternion d = conjugate(a) * b;
  return 2.0 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::abs(d.w)) / kDegree;
}

class EveryEstimator : public testing::TestWithParam<std::string_view> {
 protected:
  std::unique_ptr<HeadingEstimator> estimator_ = std::move(make_heading_estimator(GetParam())).value();
};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryEstimator, testing::ValuesIn([] {
                           std::vector<std::string_view> names;
                           for (const auto& row : heading_estimators()) names.push_back(row.name);
                           return names;
                         }()),
                         [](const auto& row) { return std::string(row.param); });

TEST_P(EveryEstimator, SaysNothingBeforeGravityWasSeen) {
  EXPECT_FALSE(estimator_->attitude());
  MargSample sample = sense(0.0, held(0));
  sample.acceleration_mps2.reset();
  estimator_->feed(sample);
  EXPECT_FALSE(estimator_->attitude());
}

TEST_P(EveryEstimator, FindsTheFourQuadrantsAndTheWrap) {
  for (const double azimuth : {0.5, 45.0, 90.0, 135.0, 179.9, 180.1, 225.0, 270.0, 315.0, 359.5}) {
    auto estimator = std::move(make_heading_estimator(GetParam())).value();
    for (int i = 0; i < 200; ++i) estimator->feed(sense(i * 0.02, held(azimuth)));
    EXPECT_NEAR(azimuth_deg(*estimator), azimuth, 0.01);
    EXPECT_EQ(estimator->attitude()->reference, HeadingReference::kMagnetic);
  }
}

TEST_P(EveryEstimator, RefersToTrueNorthOnceTheFieldIsKnown) {
  for (int i = 0; i < 200; ++i) estimator_->feed(sense(i * 0.02, held(90)));
  estimator_->expect({.declination_rad = 5 * kDegree, .dip_rad = 60 * kDegree, .norm_ut = 50});
  EXPECT_NEAR(azimuth_deg(*estimator_), 95.0, 0.01);  // magnetic north stands 5 degrees east of true north
  EXPECT_EQ(estimator_->attitude()->reference, HeadingReference::kTrue);
}

TEST_P(EveryEstimator, IgnoresAndCountsWhatCannotBeUsed) {
  auto clean = std::move(make_heading_estimator(GetParam())).value();
  for (int i = 0; i < 100; ++i) {
    const MargSample sample = sense(i * 0.02, held(30, 20, 10), {0.01, 0.02, 0.03});
    clean->feed(sample);
    estimator_->feed(sample);
    estimator_->feed(sample);  // duplicate, dt = 0
    MargSample stale = sense(i * 0.02 - 0.5, held(200));
    estimator_->feed(stale);
    MargSample broken = sense(i * 0.02 + 0.01, held(0));
    broken.acceleration_mps2 = Vector3{kNan, 0, 0};
    broken.turn_rate_radps = Vector3{0, std::numeric_limits<double>::infinity(), 0};
    broken.field_ut = Vector3{9999, 0, 0};
    broken.time = sample.time + std::chrono::milliseconds(1);
    estimator_->feed(broken);
  }
  EXPECT_LT(angle_between_deg(clean->attitude()->body_to_enu, estimator_->attitude()->body_to_enu), 1e-9);
  const SampleCounts counts = estimator_->counts();
  EXPECT_EQ(counts.used, 300u);
  EXPECT_EQ(counts.duplicate, 300u);
  EXPECT_EQ(counts.not_finite, 200u);
  EXPECT_EQ(counts.overrange, 100u);
  EXPECT_GE(counts.stale, 3u * 99);
}

TEST_P(EveryEstimator, SurvivesGapsAndGoesOn) {
  for (int i = 0; i < 100; ++i) estimator_->feed(sense(i * 0.02, held(10)));
  for (int i = 0; i < 500; ++i) estimator_->feed(sense(3600.0 + i * 0.02, held(250)));  // turned in the pocket meanwhile
  EXPECT_NEAR(azimuth_deg(*estimator_), 250.0, 1.0);
  EXPECT_LE(estimator_->attitude()->heading_sigma_rad, 1.0);
}

TEST_P(EveryEstimator, SameSamplesSameBits) {
  auto other = std::move(make_heading_estimator(GetParam())).value();
  for (int i = 0; i < 500; ++i) {
    const MargSample sample = sense(i * 0.013, held(i * 0.7, 30 * std::sin(i * 0.01), i * 0.1), {0.1, -0.2, 0.3});
    estimator_->feed(sample);
    other->feed(sample);
    EXPECT_EQ(estimator_->attitude()->body_to_enu, other->attitude()->body_to_enu);
  }
}

TEST(ComplementaryHeading, HoldsAtAnyTilt) {
  for (const double pitch : {-80.0, -30.0, 0.0, 45.0, 89.0, 120.0, 180.0}) {
    for (const double roll : {-170.0, -90.0, 0.0, 60.0, 150.0}) {
      ComplementaryHeading estimator;
      const Quaternion truth = held(77, pitch, roll);
      for (int i = 0; i < 100; ++i) estimator.feed(sense(i * 0.02, truth));
      EXPECT_LT(angle_between_deg(truth, estimator.attitude()->body_to_enu), 0.01) << pitch << " " << roll;
    }
  }
}

// Turning at 90 degrees a second about up: after one second the heading is 90 degrees to the left.
TEST(ComplementaryHeading, KeepsARelativeHeadingFromTheGyroscopeAlone) {
  ComplementaryHeading estimator;
  const double rate = 90 * kDegree;
  double start = 0.0;
  for (int i = 0; i <= 100; ++i) {
    MargSample sample = sense(i * 0.01, about_up(rate * i * 0.01), {0, 0, rate});
    sample.field_ut.reset();
    estimator.feed(sample);
    if (i == 0) start = estimator.attitude()->heading.radians();
  }
  const Attitude attitude = *estimator.attitude();
  EXPECT_EQ(attitude.reference, HeadingReference::kArbitrary);
  EXPECT_NEAR(wrap_angle_rad(attitude.heading.radians() - start), rate, 1e-6);
}

TEST(ComplementaryHeading, TheBlendIsTakenOnTheCircle) {
  // Heading -179 degrees by the gyroscope, +179 by the compass: the blend with W = 0.7 is +179.6 degrees, not 71.6.
  ComplementaryHeading estimator;
  estimator.feed(sense(0.0, held(269)));             // -179 degrees from east
  estimator.feed(sense(0.01, held(271)));            // 179
  const double blended_deg = estimator.attitude()->heading.radians() / kDegree;
  EXPECT_NEAR(std::abs(blended_deg), 179.6, 1e-3);
}

TEST(PrintedComplementaryHeading, AgreesNearLevelAndFailsWhenTilted) {
  PrintedComplementaryHeading near_level, tilted;
  for (int i = 0; i < 100; ++i) {
    near_level.feed(sense(i * 0.02, held(123, 2, 0)));
    tilted.feed(sense(i * 0.02, held(123, 60, 60)));
  }
  EXPECT_NEAR(azimuth_deg(near_level), 123.0, 0.1);
  EXPECT_GT(angle_between_deg(tilted.attitude()->body_to_enu, held(123, 60, 60)), 5.0);
}

TEST(HeadingEstimators, AnUnknownNameIsAFaultThatNamesTheKnownOnes) {
  const auto made = make_heading_estimator("astrolabe");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.fault().code, FaultCode::kUnknownName);
  EXPECT_NE(made.fault().cause.find("complementary"), std::string::npos);
}

}  // namespace
}  // namespace wayfuse
