#pragma once

#include <Eigen/Dense>

#include "server/tracking/measurement_model.hpp"
#include "server/tracking/state.hpp"

namespace wayfuse {

using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using Vector4 = Eigen::Vector4d;
inline constexpr int kMostRows = MeasurementModel::kMostDimensions;
// m values of a measurement, m x 4 derivatives, m x m covariances: sized at run time, kept on the stack.
using MeasurementVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostRows, 1>;
using MeasurementJacobian = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor, kMostRows, 4>;
using MeasurementSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostRows, kMostRows>;
using GainMatrix = Eigen::Matrix<double, 4, Eigen::Dynamic, 0, 4, kMostRows>;

inline Vector4 vector_of(const State& s) { return {s.x_m, s.y_m, s.vx_mps, s.vy_mps}; }
inline State state_of(const Vector4& v) { return {v[0], v[1], v[2], v[3]}; }
inline Matrix4 matrix_of(const StateMatrix& m) { return Eigen::Map<const Matrix4>(m.data()); }
inline StateMatrix array_of(const Matrix4& m) {
  StateMatrix out;
  Eigen::Map<Matrix4>(out.data()) = m;
  return out;
}
template <typename Matrix>
std::span<double> values_of(Matrix& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

}  // namespace wayfuse
