#include "server/pipeline/odometry.hpp"

#include <gtest/gtest.h>

namespace wayfuse {
namespace {

PhoneTime at_s(double time_s) { return PhoneTime(from_seconds(time_s)); }

// Two seconds east at 1.2 m/s, told every half a second, from 10 s on.
Odometry walked_east() {
  Odometry odometry;
  for (int i = 0; i <= 4; ++i) odometry.move(at_s(10.0 + 0.5 * i), i == 0 ? 0.0 : 0.6, 0.0);
  return odometry;
}

TEST(Odometry, BetweenReportsIsInterpolated) {
  const Odometry odometry = walked_east();
  EXPECT_NEAR(odometry.at(at_s(10.75)).x_m, 0.9, 1e-9);
  EXPECT_EQ(odometry.at(at_s(3.0)), BuildingPoint{});
  EXPECT_NEAR(odometry.now().x_m, 2.4, 1e-9);
}

TEST(Odometry, ReportsComeLateSoAWalkerGoesOnForASecond) {
  const Odometry odometry = walked_east();
  EXPECT_NEAR(odometry.at(at_s(12.5)).x_m, 2.4 + 0.6, 1e-9);
  EXPECT_NEAR(odometry.at(at_s(13.0)).x_m, 2.4 + 1.2, 1e-9);
  EXPECT_NEAR(odometry.at(at_s(60.0)).x_m, 2.4 + 1.2, 1e-9);  // whoever is silent for long has not walked all the while
  EXPECT_NEAR(odometry.now().x_m, 2.4, 1e-9);
}

TEST(Odometry, AtRestNobodyGoesOn) {
  Odometry odometry = walked_east();
  for (int i = 1; i <= 3; ++i) odometry.move(at_s(12.0 + 0.5 * i), 0.0, 0.0);
  EXPECT_EQ(odometry.at(at_s(14.0)), odometry.now());
  EXPECT_EQ(Odometry().at(at_s(1.0)), BuildingPoint{});
}

}  // namespace
}  // namespace wayfuse
