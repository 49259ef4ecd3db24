#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "server/tracking/catalogue.hpp"
#include "server/tracking/fix_measurement.hpp"
#include "server/tracking/range_measurement.hpp"
#include "server/tracking/velocity_measurements.hpp"
#include "wayfuse/proto/heading.hpp"

namespace wayfuse {
namespace {

constexpr double kPi = std::numbers::pi;

std::array<double, 4> array_of(const State& s) { return {s.x_m, s.y_m, s.vx_mps, s.vy_mps}; }
State state_of(const std::array<double, 4>& a) { return {a[0], a[1], a[2], a[3]}; }

std::shared_ptr<const MotionModel> standard(const MotionModelRow& row) {
  return row.make(*check_settings(row.description, {row.description.name, {}}, ""));
}

Motion some_motion() {
  return {.dt_s = 0.7, .heading_rad = 2.2, .heading_sigma_rad = 0.15, .distance_m = 0.9, .distance_sigma_m = 0.12, .spread_m = 0.0,
          .steps = 1};
}

const State kSomewhere{3.0, -2.0, 0.8, -0.5};

std::shared_ptr<const MotionModel> motion_model(const char* name, std::map<std::string, double> settings) {
  const MotionModelRow& row = *std::ranges::find_if(motion_model_catalogue(), [&](const auto& each) { return each.description.name == name; });
  return row.make(*check_settings(row.description, {name, std::move(settings)}, ""));
}

// The covariance of `a` and `b`, about given means.
double covariance(std::span<const float> a, double mean_a, std::span<const float> b, double mean_b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (static_cast<double>(a[i]) - mean_a) * (static_cast<double>(b[i]) - mean_b);
  return sum / static_cast<double>(a.size());
}

TEST(MotionModels, EveryJacobianEqualsTheNumericOne) {
  for (const MotionModelRow& row : motion_model_catalogue()) {
    const auto model = standard(row);
    const StateMatrix jacobian = model->jacobian(kSomewhere, some_motion());
    for (std::size_t column = 0; column < 4; ++column) {
      constexpr double kStep = 1e-5;
      auto above = array_of(kSomewhere), below = array_of(kSomewhere);
      above[column] += kStep;
      below[column] -= kStep;
      const auto a = array_of(model->propagate(state_of(above), some_motion()));
      const auto b = array_of(model->propagate(state_of(below), some_motion()));
      for (std::size_t line = 0; line < 4; ++line) {
        EXPECT_NEAR(jacobian[4 * line + column], (a[line] - b[line]) / (2 * kStep), 1e-7) << row.description.name << line << column;
      }
    }
  }
}

// Particles and the Gaussian form must be two faces of one model: mean and covariance of a cloud after one propagation.
TEST(MotionModels, ParticlesSpreadAsTheirGaussianFormSays) {
  for (const MotionModelRow& row : motion_model_catalogue()) {
    const auto model = standard(row);
    Random random(4);
    ParticleCloud cloud(100000, model->columns());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      cloud.x_m()[i] = 3.0f;
      cloud.y_m()[i] = -2.0f;
      if (cloud.has(ParticleCloud::kVx)) {
        cloud.vx_mps()[i] = 0.8f;
        cloud.vy_mps()[i] = -0.5f;
      }
    }
    model->start(cloud, random);
    model->propagate(cloud, some_motion(), random);
    const State mean = model->propagate(kSomewhere, some_motion());
    const StateMatrix noise = model->noise(kSomewhere, some_motion());
    double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double dx = static_cast<double>(cloud.x_m()[i]) - mean.x_m, dy = static_cast<double>(cloud.y_m()[i]) - mean.y_m;
      x += dx, y += dy, xx += dx * dx, xy += dx * dy, yy += dy * dy;
    }
    const auto n = static_cast<double>(cloud.size());
    // A drawn angle bends the mean by d (1 - exp(-s^2/2)) ~ 0.9 * 0.0125: 1.2 cm; beyond that, Monte Carlo.
    EXPECT_NEAR(x / n, 0.0, 0.015) << row.description.name;
    EXPECT_NEAR(y / n, 0.0, 0.015) << row.description.name;
    const double scale = noise[0] + noise[5] + 1e-6;
    EXPECT_NEAR(xx / n, noise[0], 0.05 * scale) << row.description.name;
    EXPECT_NEAR(xy / n, noise[1], 0.05 * scale) << row.description.name;
    EXPECT_NEAR(yy / n, noise[5], 0.05 * scale) << row.description.name;
  }
}

// A street towards azimuth 30: 30 degrees clockwise from y, along (1/2, sqrt(3)/2) and across (-sqrt(3)/2, 1/2).
TEST(StreetMotion, SpreadsAlongAndAcrossItsAxis) {
  constexpr double kAlong[] = {0.5, 0.8660254037844386}, kAcross[] = {-0.8660254037844386, 0.5};
  constexpr double kSigmas[] = {0.4, 0.1, 0.7, 0.2};  // of the place along and across, of the speed along and across
  const auto street = motion_model("street", {{"axis_azimuth_deg", 30}, {"along_sigma_m_rts", kSigmas[0]}, {"across_sigma_m_rts", kSigmas[1]},
                                              {"along_sigma_mps_rts", kSigmas[2]}, {"across_sigma_mps_rts", kSigmas[3]}});
  const Motion two_seconds{.dt_s = 2.0};
  const StateMatrix noise = street->noise(kSomewhere, two_seconds);
  Random random(4);
  ParticleCloud cloud(100000, street->columns());  // all of them at rest in the origin
  street->propagate(cloud, two_seconds, random);
  const std::span<const float> columns[] = {cloud.x_m(), cloud.y_m(), cloud.vx_mps(), cloud.vy_mps()};
  for (std::size_t half = 0; half < 2; ++half) {
    const double along2 = 2.0 * kSigmas[2 * half] * kSigmas[2 * half], across2 = 2.0 * kSigmas[2 * half + 1] * kSigmas[2 * half + 1];
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        const double expected = along2 * kAlong[i] * kAlong[k] + across2 * kAcross[i] * kAcross[k];
        EXPECT_NEAR(noise[4 * (2 * half + i) + 2 * half + k], expected, 1e-12) << half << i << k;
        EXPECT_NEAR(covariance(columns[2 * half + i], 0.0, columns[2 * half + k], 0.0), expected, 0.02 * along2) << half << i << k;
      }
    }
  }
}

// Exact steps: what is left is each particle's own stride and compass error, and where they drift to.
TEST(StepsMotion, EachParticleGoesByItsOwnStrideAndCompass) {
  const auto steps = motion_model("steps", {{"length_share", 0}, {"heading_sigma_rad", 0}, {"bias_sigma_rad", 0.3}, {"scale_sigma", 0.1}});
  Random random(4);
  ParticleCloud cloud(20000, steps->columns());
  steps->start(cloud, random);
  const std::span<const float> strides = cloud.stride_scale(), biases = cloud.heading_bias_rad();
  EXPECT_NEAR(covariance(strides, 1.0, strides, 1.0), 0.1 * 0.1, 0.001);
  EXPECT_NEAR(covariance(biases, 0.0, biases, 0.0), 0.3 * 0.3, 0.005);
  steps->propagate(cloud, Motion{.dt_s = 1.0, .heading_rad = 0.4, .distance_m = 2.0}, random);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_NEAR(cloud.x_m()[i], 2.0f * strides[i] * std::cos(0.4f + biases[i]), 1e-5f);
    ASSERT_NEAR(cloud.y_m()[i], 2.0f * strides[i] * std::sin(0.4f + biases[i]), 1e-5f);
  }
}

TEST(StepsMotion, CompassErrorsDriftWithTheRootOfTime) {
  const auto steps = motion_model("steps", {{"bias_drift_rad_rts", 0.05}});
  Random random(4);
  ParticleCloud cloud(20000, steps->columns());
  for (int i = 0; i < 8; ++i) steps->propagate(cloud, Motion{.dt_s = 0.5, .at_rest = true}, random);
  const std::span<const float> biases = cloud.heading_bias_rad();
  EXPECT_NEAR(covariance(biases, 0.0, biases, 0.0), 4.0 * 0.05 * 0.05, 0.0005);
  EXPECT_EQ(covariance(cloud.x_m(), 0.0, cloud.x_m(), 0.0), 0.0) << "at rest only the compass drifts";
}

std::vector<std::unique_ptr<MeasurementModel>> measurements() {
  std::vector<std::unique_ptr<MeasurementModel>> all;
  all.push_back(std::make_unique<FixMeasurement>(1.0, 2.0, 1.5));
  all.push_back(std::make_unique<SpeedMeasurement>(1.3, 0.2));
  all.push_back(std::make_unique<DirectionMeasurement>(3.0, 0.2));
  all.push_back(std::make_unique<ResolvedVelocityMeasurement>(1.3, 0.2, 3.0, 0.4));
  auto ranges = std::make_unique<RangeMeasurement>();
  ranges->add({10.0, 0.0, 8.0, 1.0});
  ranges->add({-3.0, 7.0, 11.0, 2.0});
  all.push_back(std::move(ranges));
  return all;
}

TEST(Measurements, EveryJacobianEqualsTheNumericOne) {
  for (const auto& measurement : measurements()) {
    const auto m = static_cast<std::size_t>(measurement->dimension());
    std::vector<double> jacobian(4 * m), above(m), below(m);
    measurement->jacobian(kSomewhere, jacobian);
    for (std::size_t column = 0; column < 4; ++column) {
      constexpr double kStep = 1e-5;
      auto a = array_of(kSomewhere), b = array_of(kSomewhere);
      a[column] += kStep;
      b[column] -= kStep;
      measurement->residual(state_of(a), above);
      measurement->residual(state_of(b), below);
      for (std::size_t row = 0; row < m; ++row) {  // the residual is z - h: its slope is minus h's
        EXPECT_NEAR(jacobian[4 * row + column], wrap_angle_rad(below[row] - above[row]) / (2 * kStep), 1e-6);
      }
    }
  }
}

TEST(Measurements, WeighParticlesByTheirOwnResidualAndVariance) {
  for (const auto& measurement : measurements()) {
    const auto m = static_cast<std::size_t>(measurement->dimension());
    ParticleCloud cloud(2, ParticleCloud::kVelocity);
    const State states[] = {kSomewhere, {3.5, -1.0, 1.1, -0.2}};
    std::array<double, 2> expected{};
    for (std::size_t i = 0; i < 2; ++i) {
      cloud.x_m()[i] = static_cast<float>(states[i].x_m);
      cloud.y_m()[i] = static_cast<float>(states[i].y_m);
      cloud.vx_mps()[i] = static_cast<float>(states[i].vx_mps);
      cloud.vy_mps()[i] = static_cast<float>(states[i].vy_mps);
      std::vector<double> residual(m), variance(m);
      measurement->residual(states[i], residual);
      measurement->variance(variance);
      for (std::size_t row = 0; row < m; ++row) expected[i] -= 0.5 * residual[row] * residual[row] / variance[row];
    }
    std::array<float, 2> gained{};
    measurement->weigh(cloud, gained);
    EXPECT_NEAR(static_cast<double>(gained[1] - gained[0]), expected[1] - expected[0], 1e-3 * std::abs(expected[0]) + 1e-4);
  }
}

TEST(DirectionMeasurement, WrapsItsResidual) {
  const DirectionMeasurement measurement(kPi - 0.1, 0.2);
  std::array<double, 1> residual{};
  measurement.residual({0, 0, -1.0, -0.1}, residual);  // pointing at -pi + 0.0997
  EXPECT_NEAR(residual[0], -0.1 - std::atan(0.1), 1e-12);
}

// One transmitter behind a wall must not decide alone: beyond 4 sigma a range costs 8 and no more.
TEST(RangeMeasurement, CostsFourSigmasAtMost) {
  RangeMeasurement measurement;
  measurement.add({0.0, 0.0, 10.0, 2.0});
  ParticleCloud cloud(3, 0);
  const float away_m[] = {16.0f, 20.0f, 500.0f};
  std::ranges::copy(away_m, cloud.x_m().begin());
  std::array<float, 3> gained{};
  measurement.weigh(cloud, gained);
  EXPECT_FLOAT_EQ(gained[0], -4.5f);  // 3 sigma: 9 / 2
  EXPECT_FLOAT_EQ(gained[1], -8.0f);
  EXPECT_FLOAT_EQ(gained[2], -8.0f);
}

TEST(RangeMeasurement, KeepsThirtyTwoAtMost) {
  RangeMeasurement measurement;
  for (int i = 0; i < 100; ++i) measurement.add({1.0 * i, 0.0, 1.0, 1.0});
  EXPECT_EQ(measurement.dimension(), MeasurementModel::kMostDimensions);
}

// Filters on models whose every step is linear must agree to the last digits.
TEST(KalmanFamily, UnscentedEqualsExtendedOnLinearModels) {
  for (const MotionModelRow& row : motion_model_catalogue()) {
    const auto model = standard(row);
    const auto made = [&](const char* name) {
      for (const FilterRow& filter : filter_catalogue()) {
        if (filter.description.name == name) {
          return filter.make(*check_settings(filter.description, {name, {}}, ""), model, nullptr);
        }
      }
      return std::unique_ptr<Filter>{};
    };
    const auto extended = made("extended-kalman"), unscented = made("unscented-kalman");
    Random random(1);
    for (Filter* filter : {extended.get(), unscented.get()}) filter->start(isotropic({1, 2, 0.5, 0.5}, 2.0, 1.0), random);
    for (int i = 0; i < 50; ++i) {
      for (Filter* filter : {extended.get(), unscented.get()}) {
        filter->predict(some_motion(), random);
        EXPECT_TRUE(filter->update(FixMeasurement(0.3 * i, std::sin(i), 2.0), random));
      }
      const GaussianState a = extended->estimate(), b = unscented->estimate();
      EXPECT_NEAR(a.mean.x_m, b.mean.x_m, 1e-7) << row.description.name;
      EXPECT_NEAR(a.mean.vy_mps, b.mean.vy_mps, 1e-7) << row.description.name;
      for (std::size_t k = 0; k < 16; ++k) EXPECT_NEAR(a.covariance[k], b.covariance[k], 1e-7) << row.description.name;
    }
  }
}

TEST(KalmanFamily, FollowsAWalkThroughSpeedAndDirectionAlone) {
  for (const char* name : {"extended-kalman", "unscented-kalman"}) {
    const MotionModelRow& row = *std::ranges::find_if(motion_model_catalogue(),
                                                      [](const auto& each) { return each.description.name == "constant-velocity"; });
    const FilterRow& filter_row =
        *std::ranges::find_if(filter_catalogue(), [&](const auto& each) { return each.description.name == name; });
    const auto filter = filter_row.make(*check_settings(filter_row.description, {name, {}}, ""), standard(row), nullptr);
    Random random(1);
    filter->start(isotropic({0, 0, 0.1, 0.1}, 0.5, 1.0), random);
    for (int i = 0; i < 400; ++i) {  // 40 s due south-west, across the wrap of the angle
      filter->predict(Motion{.dt_s = 0.1}, random);
      EXPECT_TRUE(filter->update(SpeedMeasurement(1.3, 0.1), random));
      EXPECT_TRUE(filter->update(DirectionMeasurement(wrap_angle_rad(kPi + 0.05 * std::sin(i)), 0.1), random));
    }
    const State end = filter->estimate().mean;
    EXPECT_NEAR(end.x_m, -52.0, 1.5) << name;
    EXPECT_NEAR(end.y_m, 0.0, 1.5) << name;
  }
}

// A measurement beyond what its row takes is refused and changes nothing; a fix moves everyone.
TEST(NewestFixFilter, TakesPlacesOnly) {
  const MotionModelRow& motion = motion_model_catalogue().front();
  const FilterRow& row = *std::ranges::find_if(filter_catalogue(), [](const auto& each) { return each.description.name == "newest-fix"; });
  const auto filter = row.make({}, standard(motion), nullptr);
  Random random(1);
  filter->start(isotropic(kSomewhere, 2.0, 1.0), random);
  for (const auto& measurement : measurements()) {
    const GaussianState before = filter->estimate();
    const bool place = dynamic_cast<const FixMeasurement*>(measurement.get()) != nullptr;
    EXPECT_EQ(filter->update(*measurement, random), place);
    EXPECT_EQ(array_of(filter->estimate().mean) != array_of(before.mean), place);
  }
}

TEST(KalmanFamily, AMinuteAndAFreshStartStayFinite) {
  for (const FilterRow& row : filter_catalogue()) {
    for (const MotionModelRow& motion : motion_model_catalogue()) {
      const auto filter = row.make(*check_settings(row.description, {row.description.name, {}}, ""), standard(motion),
                                   resampler_catalogue()[1].make({}));
      Random random(1);
      filter->start(isotropic({}, 0.0, 0.0), random);  // not a grain of doubt
      Motion minute = some_motion();
      minute.dt_s = 60.0;
      minute.spread_m = 40.0;
      filter->predict(minute, random);
      const GaussianState before = filter->estimate();
      const bool moves = motion.description.name != "still";
      EXPECT_EQ(before.covariance[0] > 0.0, moves) << row.description.name << " " << motion.description.name;
      EXPECT_TRUE(filter->update(FixMeasurement(5.0, 5.0, 1e-3), random)) << row.description.name << " " << motion.description.name;
      const GaussianState state = filter->estimate();
      EXPECT_TRUE(std::isfinite(state.mean.x_m) && std::isfinite(state.covariance[0])) << row.description.name;
      const auto off_m = [](const State& mean) { return std::hypot(mean.x_m - 5.0, mean.y_m - 5.0); };
      EXPECT_TRUE(!moves || off_m(state.mean) < off_m(before.mean)) << row.description.name << " " << motion.description.name;
    }
  }
}

}  // namespace
}  // namespace wayfuse
