#include "server/pipeline/field_measurement.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/pipeline/beacon.hpp"

namespace wayfuse {
namespace {

// Four particles that went 5 m since the scan was heard, (3, 4) by the phone: plain, turned by 90 degrees, twice as far, and both.
TEST(FieldMeasurement, WeighsEachParticleWhereItWasWhenTheScanWasHeard) {
  constexpr float kQuarter = 1.5707963f;
  constexpr std::array<float, 4> kBias = {0.0f, kQuarter, 0.0f, kQuarter}, kStride = {1.0f, 1.0f, 2.0f, 2.0f};
  constexpr std::array<BuildingPoint, 4> kWent = {{{3.0, 4.0}, {-4.0, 3.0}, {6.0, 8.0}, {-8.0, 6.0}}};
  constexpr std::array<BuildingPoint, 4> kWere = {{{1.0, 0.0}, {-2.0, 3.0}, {4.0, -1.0}, {0.0, 5.0}}};
  ParticleCloud cloud(4, ParticleCloud::kBias | ParticleCloud::kScale);
  std::array<double, 4> log_likelihood{};
  for (std::size_t i = 0; i < 4; ++i) {
    cloud.x_m()[i] = static_cast<float>(kWere[i].x_m + kWent[i].x_m);
    cloud.y_m()[i] = static_cast<float>(kWere[i].y_m + kWent[i].y_m);
    cloud.heading_bias_rad()[i] = kBias[i];
    cloud.stride_scale()[i] = kStride[i];
    log_likelihood[i] = -(kWere[i].x_m * kWere[i].x_m + kWere[i].y_m * kWere[i].y_m) / 18.0;  // the beacon's own, 3 m about the origin
  }
  const Beacon beacon({0.0, 0.0});
  FieldScratch scratch;
  std::array<float, 4> gained{};
  FieldMeasurement(beacon, FloorOrdinal{0}, {3.0, 4.0}, 2.0, 0.1, scratch).weigh(cloud, gained);
  for (std::size_t i = 0; i < 4; ++i) {  // the first is the nearest
    EXPECT_NEAR(gained[i], std::log(std::exp(2.0 * (log_likelihood[i] - log_likelihood[0])) + 0.1), 1e-5) << i;
  }
}

}  // namespace
}  // namespace wayfuse
