#include "wayfuse/proto/magnetic_model.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace wayfuse {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Declination, dip and strength of the full model (degree 12), epoch 2020.0 on the ground, from NOAA's test values.
TEST(MainField, AgreesWithTheFullModelAwayFromThePoles) {
  const MagneticField equator = main_field({0.0, 120.0}, 2020.0);
  EXPECT_NEAR(equator.declination_rad / kDegree, 0.16, 0.5);
  EXPECT_NEAR(equator.dip_rad / kDegree, -15.42, 0.5);
  EXPECT_NEAR(equator.norm_ut, 41.10, 0.5);
  EXPECT_NEAR(main_field({-80.0, 240.0}, 2020.0).declination_rad / kDegree, 69.36, 3.0);
}

TEST(MainField, DriftsWithTheYearsAndStaysFiniteAtThePoles) {
  EXPECT_NE(main_field({48.0, 11.0}, 2020.0).declination_rad, main_field({48.0, 11.0}, 2025.0).declination_rad);
  EXPECT_GT(main_field({90.0, 0.0}, 2020.0).norm_ut, 50.0);
  EXPECT_LT(main_field({-90.0, 0.0}, 2020.0).dip_rad, 0.0);
}

}  // namespace
}  // namespace wayfuse
