#pragma once

#include <span>

#include "server/tracking/particle_cloud.hpp"
#include "server/tracking/state.hpp"

namespace wayfuse {

/// One piece of evidence, ready to be weighed: a small value made for the occasion.
class MeasurementModel {
 public:
  virtual ~MeasurementModel() = default;

  /// Adds log p(z | particle), up to a constant, to each entry of `log_weight` (cloud.size() of them).
  virtual void weigh(const ParticleCloud& cloud, std::span<float> log_weight) const = 0;

  /// Gaussian form, for the Kalman family: independent components. 0 = there is none, particles only.
  virtual int dimension() const { return 0; }
  /// z - h(state), angles wrapped; dimension() values.
  virtual void residual(const State& /*state*/, std::span<double> /*out*/) const {}
  /// dh/dstate, dimension() x 4, row-major.
  virtual void jacobian(const State& /*state*/, std::span<double> /*out*/) const {}
  /// Variances of z; dimension() values.
  virtual void variance(std::span<double> /*out*/) const {}
  /// Whether component i is an angle, whose differences wrap.
  virtual bool is_angle(int /*i*/) const { return false; }

  static constexpr int kMostDimensions = 32;
};

}  // namespace wayfuse
