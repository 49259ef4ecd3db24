#pragma once

#include "server/tracking/measurement_model.hpp"

namespace wayfuse {

/// An absolute point: w_i ~ exp(-|x_i - z|^2 / 2 sigma^2) [P1 eq. 13].
///
/// Differs from [P1 eq. 13]: the printed normaliser is left out, it cancels in eq. 14.
class FixMeasurement final : public MeasurementModel {
 public:
  FixMeasurement(double x_m, double y_m, double sigma_m) : x_m_(x_m), y_m_(y_m), sigma_m_(sigma_m) {}
  void weigh(const ParticleCloud& cloud, std::span<float> log_weight) const override;
  int dimension() const override { return 2; }
  void residual(const State& state, std::span<double> out) const override;
  void jacobian(const State& state, std::span<double> out) const override;
  void variance(std::span<double> out) const override;

 private:
  double x_m_;
  double y_m_;
  double sigma_m_;
};

}  // namespace wayfuse
