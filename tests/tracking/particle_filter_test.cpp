#include "server/tracking/particle_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "server/tracking/fix_measurement.hpp"
#include "server/tracking/gaussian_filters.hpp"
#include "server/tracking/resamplers.hpp"
#include "server/tracking/walk_motion.hpp"

namespace wayfuse {
namespace {

Motion step_east() { return {.dt_s = 1.0, .heading_rad = 0.3, .heading_sigma_rad = 0.1, .distance_m = 1.2, .distance_sigma_m = 0.2}; }

std::unique_ptr<Filter> particles(int count) {
  return std::make_unique<ParticleFilter>(ParticleFilterSettings{count, 0.5}, std::make_shared<WalkMotion>(WalkSettings{}),
                                          std::make_shared<SystematicResampler>());
}

TEST(ParticleFilter, EqualsTheKalmanFilterOnALinearGaussianWalk) {
  Random random(1);
  const auto filter = particles(40000);
  ExtendedKalmanFilter kalman(std::make_shared<WalkMotion>(WalkSettings{}));
  const auto start = isotropic({}, 2.0, 1.0);
  filter->start(start, random);
  kalman.start(start, random);
  for (int step = 0; step < 20; ++step) {
    filter->predict(step_east(), random);
    kalman.predict(step_east(), random);
    const FixMeasurement fix(1.2 * step + std::sin(step), 0.3 * step, 1.5);
    ASSERT_TRUE(filter->update(fix, random));
    ASSERT_TRUE(kalman.update(fix, random));
    const GaussianState a = filter->estimate();
    const GaussianState b = kalman.estimate();
    // The Monte Carlo error of 40,000 particles, many resamplings: well inside 3 cm and 6 % of the variance.
    EXPECT_NEAR(a.mean.x_m, b.mean.x_m, 0.03) << step;
    EXPECT_NEAR(a.mean.y_m, b.mean.y_m, 0.03) << step;
    EXPECT_NEAR(a.covariance[0], b.covariance[0], 0.06 * b.covariance[0]) << step;
    EXPECT_NEAR(a.covariance[1], b.covariance[1], 0.06 * b.covariance[0]) << step;
  }
  EXPECT_NEAR(filter->radius_m(0.68), kalman.radius_m(0.68), 0.03 * kalman.radius_m(0.68));
}

TEST(ParticleFilter, SurvivesAFixAKilometreAway) {
  Random random(2);
  const auto filter = particles(200);
  filter->start(isotropic({}, 1.0, 1.0), random);
  EXPECT_TRUE(filter->update(FixMeasurement(1000.0, 0.0, 0.5), random));  // log-likelihood about -2,000,000
  EXPECT_TRUE(std::isfinite(filter->estimate().mean.x_m));
  EXPECT_NEAR(filter->estimate().mean.x_m, 3.0, 2.0);  // the particle nearest to it
}

TEST(ParticleFilter, RefusesEvidenceThatIsImpossibleEverywhere) {
  Random random(2);
  const auto filter = particles(50);
  filter->start(isotropic({5.0, 5.0, 0.0, 0.0}, 1.0, 1.0), random);
  const GaussianState before = filter->estimate();
  EXPECT_FALSE(filter->update(FixMeasurement(NAN, 0.0, 1.0), random));
  EXPECT_FALSE(filter->update(FixMeasurement(INFINITY, 0.0, 1.0), random));
  EXPECT_EQ(filter->estimate().mean.x_m, before.mean.x_m);
}

TEST(ParticleFilter, RepeatsItselfFromTheSameSeed) {
  const auto run = [] {
    Random random(77);
    const auto filter = particles(300);
    filter->start(isotropic({}, 2.0, 1.0), random);
    for (int step = 0; step < 50; ++step) {
      filter->predict(step_east(), random);
      filter->update(FixMeasurement(step, 0.0, 3.0), random);
    }
    return filter->estimate();
  };
  const GaussianState a = run();
  const GaussianState b = run();
  EXPECT_EQ(a.mean.x_m, b.mean.x_m);
  EXPECT_EQ(a.covariance, b.covariance);
}

}  // namespace
}  // namespace wayfuse
