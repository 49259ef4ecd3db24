#include "server/tracking/gaussian_filters.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "server/tracking/gaussian_algebra.hpp"

namespace wayfuse {
namespace {

constexpr std::array<double, 8> kOfAPlace = {1, 0, 0, 0, 0, 1, 0, 0};

GaussianState predicted(const GaussianState& belief, const MotionModel& model, const Motion& motion) {
  const Matrix4 f = matrix_of(model.jacobian(belief.mean, motion));
  const Matrix4 q = matrix_of(model.noise(belief.mean, motion));
  return {model.propagate(belief.mean, motion), array_of(f * matrix_of(belief.covariance) * f.transpose() + q)};
}

}  // namespace

void GaussianFilter::start(const GaussianState& about, Random&) {
  belief_ = about;
  started_ = true;
}

bool GaussianFilter::take(const GaussianState& belief) {
  GaussianState next = belief;
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < row; ++column) {
      const double mean = 0.5 * (next.covariance[row * 4 + column] + next.covariance[column * 4 + row]);
      next.covariance[row * 4 + column] = next.covariance[column * 4 + row] = mean;
    }
  }
  const auto finite = [](double value) { return std::isfinite(value); };
  const std::array mean = {next.mean.x_m, next.mean.y_m, next.mean.vx_mps, next.mean.vy_mps};
  if (!std::ranges::all_of(mean, finite) || !std::ranges::all_of(next.covariance, finite)) return false;
  belief_ = next;
  return true;
}

double GaussianFilter::radius_m(double share) const {
  // The exact quantile for equal axes; for unequal ones the root of their mean square stands in (within 6 %).
  const double mean_variance = 0.5 * (belief_.covariance[0] + belief_.covariance[5]);
  return std::sqrt(std::max(0.0, -2.0 * std::log1p(-std::clamp(share, 0.0, 0.999999)) * mean_variance));
}

void ExtendedKalmanFilter::predict(const Motion& motion, Random&) { take(predicted(belief_, *motion_, motion)); }

bool ExtendedKalmanFilter::update(const MeasurementModel& measurement, Random&) {
  const int m = measurement.dimension();
  assert(m <= kMostRows);
  if (m == 0) return false;
  MeasurementJacobian h(m, 4);
  MeasurementVector innovation(m), variance(m);
  measurement.jacobian(belief_.mean, values_of(h));
  measurement.residual(belief_.mean, values_of(innovation));
  measurement.variance(values_of(variance));
  const Matrix4 p = matrix_of(belief_.covariance);
  MeasurementSquare s = h * p * h.transpose();
  s.diagonal() += variance;
  const Eigen::LDLT<MeasurementSquare> solver(s);
  if (solver.info() != Eigen::Success || !solver.isPositive()) return false;
  const MeasurementJacobian hp = h * p;
  const GainMatrix gain = solver.solve(hp).transpose();
  const Matrix4 kept = Matrix4::Identity() - gain * h;
  const Matrix4 next = kept * p * kept.transpose() + gain * variance.asDiagonal() * gain.transpose();
  return take({state_of(vector_of(belief_.mean) + gain * innovation), array_of(next)});
}

void NewestFixFilter::predict(const Motion& motion, Random&) { take(predicted(belief_, *motion_, motion)); }

bool NewestFixFilter::update(const MeasurementModel& measurement, Random&) {
  if (measurement.dimension() != 2) return false;
  std::array<double, 8> jacobian{};
  measurement.jacobian(belief_.mean, jacobian);
  if (jacobian != kOfAPlace) return false;  // two numbers, but no place
  std::array<double, 2> residual{}, variance{};
  measurement.residual(belief_.mean, residual);
  measurement.variance(variance);
  GaussianState next = belief_;
  next.mean.x_m += residual[0];
  next.mean.y_m += residual[1];
  next.covariance = {};
  next.covariance[0] = variance[0];
  next.covariance[5] = variance[1];
  return take(next);
}

}  // namespace wayfuse
