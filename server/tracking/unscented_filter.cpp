#include "server/tracking/unscented_filter.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "server/tracking/gaussian_algebra.hpp"
#include "wayfuse/proto/heading.hpp"

namespace wayfuse {
namespace {

constexpr int kPoints = 9;  // 2 x 4 + 1

struct SigmaPoints {
  std::array<Vector4, kPoints> point;
  std::array<double, kPoints> mean_weight;
  std::array<double, kPoints> covariance_weight;
};

// Absent when the covariance has no root: numerically lost.
bool draw(const GaussianState& belief, const UnscentedSettings& settings, SigmaPoints& out) {
  constexpr double n = 4.0;
  const double lambda = settings.alpha * settings.alpha * (n + settings.kappa) - n;
  const Matrix4 p = matrix_of(belief.covariance);
  // LDL^T roots a semi-definite matrix too: a position-only model has no spread in some directions.
  const Eigen::LDLT<Matrix4> ldlt(p);
  if (ldlt.info() != Eigen::Success) return false;
  const Vector4 d = ldlt.vectorD().cwiseMax(0.0).cwiseSqrt() * std::sqrt(n + lambda);
  const Matrix4 lower = ldlt.matrixL();
  const Matrix4 root = ldlt.transpositionsP().transpose() * (lower * d.asDiagonal()).eval();
  const Vector4 mean = vector_of(belief.mean);
  out.point[0] = mean;
  for (int i = 0; i < 4; ++i) {
    out.point[static_cast<std::size_t>(1 + i)] = mean + root.col(i);
    out.point[static_cast<std::size_t>(5 + i)] = mean - root.col(i);
  }
  out.mean_weight.fill(0.5 / (n + lambda));
  out.mean_weight[0] = lambda / (n + lambda);
  out.covariance_weight = out.mean_weight;
  out.covariance_weight[0] += 1.0 - settings.alpha * settings.alpha + settings.beta;
  return true;
}

}  // namespace

void UnscentedKalmanFilter::predict(const Motion& motion, Random&) {
  SigmaPoints sigma;
  if (!draw(belief_, settings_, sigma)) return;
  const StateMatrix noise = motion_->noise(belief_.mean, motion);
  Vector4 mean = Vector4::Zero();
  for (std::size_t i = 0; i < kPoints; ++i) {
    sigma.point[i] = vector_of(motion_->propagate(state_of(sigma.point[i]), motion));
    mean += sigma.mean_weight[i] * sigma.point[i];
  }
  Matrix4 covariance = matrix_of(noise);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Vector4 off = sigma.point[i] - mean;
    covariance += sigma.covariance_weight[i] * off * off.transpose();
  }
  take({state_of(mean), array_of(covariance)});
}

bool UnscentedKalmanFilter::update(const MeasurementModel& measurement, Random&) {
  const int m = measurement.dimension();
  assert(m <= kMostRows);
  SigmaPoints sigma;
  if (m == 0 || !draw(belief_, settings_, sigma)) return false;
  MeasurementVector variance(m);
  measurement.variance(values_of(variance));
  // Residuals z - h(x_i) stand in for h(x_i): their spread is the same, their mean is the innovation. Angles are unwrapped
  // towards the residual of the mean point first.
  std::array<MeasurementVector, kPoints> residual;
  MeasurementVector innovation = MeasurementVector::Zero(m);
  for (std::size_t i = 0; i < kPoints; ++i) {
    residual[i].resize(m);
    measurement.residual(state_of(sigma.point[i]), values_of(residual[i]));
    for (int row = 0; row < m; ++row) {
      if (measurement.is_angle(row)) residual[i][row] = residual[0][row] + wrap_angle_rad(residual[i][row] - residual[0][row]);
    }
    innovation += sigma.mean_weight[i] * residual[i];
  }
  MeasurementSquare s = variance.asDiagonal();
  GainMatrix cross = GainMatrix::Zero(4, m);
  const Vector4 mean = vector_of(belief_.mean);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const MeasurementVector off = residual[i] - innovation;
    s += sigma.covariance_weight[i] * off * off.transpose();
    cross -= sigma.covariance_weight[i] * (sigma.point[i] - mean) * off.transpose();
  }
  for (int row = 0; row < m; ++row) {
    if (measurement.is_angle(row)) innovation[row] = wrap_angle_rad(innovation[row]);
  }
  const Eigen::LDLT<MeasurementSquare> solver(s);
  if (solver.info() != Eigen::Success || !solver.isPositive()) return false;
  const GainMatrix gain = solver.solve(cross.transpose()).transpose();
  const Matrix4 covariance = matrix_of(belief_.covariance) - gain * s * gain.transpose();
  return take({state_of(mean + gain * innovation), array_of(covariance)});
}

}  // namespace wayfuse
