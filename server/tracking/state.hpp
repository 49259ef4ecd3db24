#pragma once

#include <array>

namespace wayfuse {

/// Position and velocity in the pipeline's frame; the order every 4-vector and 4 x 4 matrix of this room uses.
struct State {
  double x_m = 0.0;
  double y_m = 0.0;
  double vx_mps = 0.0;
  double vy_mps = 0.0;
};

/// 4 x 4, row-major, order x_m y_m vx_mps vy_mps.
using StateMatrix = std::array<double, 16>;

struct GaussianState {
  State mean;
  StateMatrix covariance{};
};

/// Independent position and velocity, the same on both axes.
inline GaussianState isotropic(const State& mean, double position_sigma_m, double velocity_sigma_mps) {
  GaussianState state{mean, {}};
  state.covariance[0] = state.covariance[5] = position_sigma_m * position_sigma_m;
  state.covariance[10] = state.covariance[15] = velocity_sigma_mps * velocity_sigma_mps;
  return state;
}

}  // namespace wayfuse
