#include "server/tracking/heading_filter.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace wayfuse {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(HeadingFilter, EqualsTheScalarKalmanFilterByHand) {
  HeadingFilter filter({.turn_sigma_rad_rts = 0.1, .track_sigma_m = 1.0});
  filter.start(0.2, 0.3);           // P = 0.09
  filter.predict(0.1, 1.0);         // phi- = 0.3, P- = 0.09 + 0.01 = 0.1
  filter.update(0.5, 2.0);          // R = (1/2)^2 = 0.25, K = 0.1 / 0.35
  EXPECT_NEAR(filter.heading_rad(), 0.3 + 0.1 / 0.35 * 0.2, 1e-12);
  EXPECT_NEAR(filter.variance_rad2(), 0.1 * 0.25 / 0.35, 1e-12);
}

TEST(HeadingFilter, CorrectsAcrossTheSouthWithoutGoingAround) {
  HeadingFilter filter({.turn_sigma_rad_rts = 0.0, .track_sigma_m = 1.0});
  filter.start(kPi - 0.1, 0.5);
  filter.update_with_variance(-kPi + 0.1, 0.25);  // equal trust: half of the 0.2 between them
  EXPECT_NEAR(std::abs(filter.heading_rad()), kPi, 1e-12);
}

TEST(HeadingFilter, FromNothingTakesTheTrack) {
  HeadingFilter filter({});
  filter.start(0.0, 100.0);
  filter.update(2.0, 50.0);
  EXPECT_NEAR(filter.heading_rad(), 2.0, 0.01);
}

TEST(HeadingFilter, IgnoresATrackOfNoLength) {
  HeadingFilter filter({});
  filter.start(1.0, 0.1);
  filter.update(2.0, 0.0);
  EXPECT_EQ(filter.heading_rad(), 1.0);
}

}  // namespace
}  // namespace wayfuse
