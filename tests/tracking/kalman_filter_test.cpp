#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/tracking/catalogue.hpp"
#include "server/tracking/fix_measurement.hpp"

// The filter of the catalogue against Kalman's recursion written out by hand, one axis at a time.
namespace wayfuse {
namespace {

std::unique_ptr<Filter> kalman_over(const char* motion_name, std::map<std::string, double> settings) {
  const MotionModelRow& motion = *std::ranges::find_if(motion_model_catalogue(), [&](const auto& row) { return row.description.name == motion_name; });
  const FilterRow& filter = *std::ranges::find_if(filter_catalogue(), [](const auto& row) { return row.description.name == "kalman"; });
  const auto model = motion.make(*check_settings(motion.description, {motion_name, {settings.begin(), settings.end()}}, ""));
  return filter.make(*check_settings(filter.description, {"kalman", {}}, ""), model, nullptr);
}

TEST(KalmanFilter, OfAPlaceThatStaysIsThePrecisionWeightedMean) {
  const auto filter = kalman_over("still", {{"wander_m_rts", 0.0}});
  Random random(1);
  filter->start(isotropic({3.0, 0.0, 0.0, 0.0}, 2.0, 1.0), random);
  double precision = 1.0 / 4.0, weighted = 3.0 / 4.0;
  for (int i = 0; i < 20; ++i) {
    const double z = std::sin(i), sigma = 1.0 + 0.1 * i;
    filter->predict(Motion{.dt_s = 1.0}, random);
    ASSERT_TRUE(filter->update(FixMeasurement(z, 0.0, sigma), random));
    precision += 1.0 / (sigma * sigma), weighted += z / (sigma * sigma);
    EXPECT_NEAR(filter->estimate().mean.x_m, weighted / precision, 1e-9);
    EXPECT_NEAR(filter->estimate().covariance[0], 1.0 / precision, 1e-9);
  }
}

TEST(KalmanFilter, OfConstantVelocityIsTheRecursionByHand) {
  constexpr double kDt = 0.5, kPlace = 0.3, kSpeed = 0.4, kFix = 2.0;
  const auto filter = kalman_over("street", {{"along_sigma_m_rts", kPlace}, {"across_sigma_m_rts", kPlace},
                                             {"along_sigma_mps_rts", kSpeed}, {"across_sigma_mps_rts", kSpeed}});
  Random random(1);
  filter->start(isotropic({1.0, 1.0, 0.2, 0.2}, 3.0, 1.0), random);
  double x = 1.0, v = 0.2, pxx = 9.0, pxv = 0.0, pvv = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double z = 0.6 * i + 2.0 * std::cos(3.0 * i);
    filter->predict(Motion{.dt_s = kDt}, random);
    ASSERT_TRUE(filter->update(FixMeasurement(z, z, kFix), random));
    x += kDt * v;
    pxx += 2 * kDt * pxv + kDt * kDt * pvv + kPlace * kPlace * kDt;
    pxv += kDt * pvv;
    pvv += kSpeed * kSpeed * kDt;
    const double s = pxx + kFix * kFix, kx = pxx / s, kv = pxv / s, innovation = z - x;
    x += kx * innovation, v += kv * innovation;
    pvv -= kv * pxv, pxv -= kx * pxv, pxx -= kx * pxx;
    const GaussianState state = filter->estimate();
    EXPECT_NEAR(state.mean.x_m, x, 1e-9);
    EXPECT_NEAR(state.mean.y_m, x, 1e-9);
    EXPECT_NEAR(state.mean.vx_mps, v, 1e-9);
    EXPECT_NEAR(state.covariance[0], pxx, 1e-9);
    EXPECT_NEAR(state.covariance[2], pxv, 1e-9);
    EXPECT_NEAR(state.covariance[10], pvv, 1e-9);
  }
}

}  // namespace
}  // namespace wayfuse
