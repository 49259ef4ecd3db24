#pragma once

#include "server/tracking/measurement_model.hpp"

namespace wayfuse {

/// Horizontal speed of a state that has a velocity: z = |v| [P5 eqs. 2, 4].
class SpeedMeasurement final : public MeasurementModel {
 public:
  SpeedMeasurement(double speed_mps, double sigma_mps) : speed_mps_(speed_mps), sigma_mps_(sigma_mps) {}
  void weigh(const ParticleCloud& cloud, std::span<float> log_weight) const override;
  int dimension() const override { return 1; }
  void residual(const State& state, std::span<double> out) const override;
  void jacobian(const State& state, std::span<double> out) const override;
  void variance(std::span<double> out) const override { out[0] = sigma_mps_ * sigma_mps_; }

 private:
  double speed_mps_;
  double sigma_mps_;
};

/// Direction of a state's velocity: z = atan2(v_y, v_x), residuals wrapped [P5 eqs. 2, 4].
///
/// Differs from [P5]: one convention of angles, counter-clockwise from x; the azimuth was converted at the edge. A velocity
/// below 5 cm/s has no direction: its Jacobian is taken there.
class DirectionMeasurement final : public MeasurementModel {
 public:
  DirectionMeasurement(double heading_rad, double sigma_rad) : heading_rad_(heading_rad), sigma_rad_(sigma_rad) {}
  void weigh(const ParticleCloud& cloud, std::span<float> log_weight) const override;
  int dimension() const override { return 1; }
  void residual(const State& state, std::span<double> out) const override;
  void jacobian(const State& state, std::span<double> out) const override;
  void variance(std::span<double> out) const override { out[0] = sigma_rad_ * sigma_rad_; }
  bool is_angle(int) const override { return true; }

 private:
  double heading_rad_;
  double sigma_rad_;
};

/// Speed resolved by the azimuth into two velocities, along the heading and across it: linear in the state, z = (v, 0)
/// [P5 eq. 4]. With a heading error e the true velocity reaches only v cos e along the heading, always less than v: a filter that
/// believes speeds more than headings makes up for it and walks too fast (7 % at 27 degrees and 0.2 m/s); measuring speed and
/// direction apart does not.
class ResolvedVelocityMeasurement final : public MeasurementModel {
 public:
  ResolvedVelocityMeasurement(double speed_mps, double speed_sigma_mps, double heading_rad, double heading_sigma_rad);
  void weigh(const ParticleCloud& cloud, std::span<float> log_weight) const override;
  int dimension() const override { return 2; }
  void residual(const State& state, std::span<double> out) const override;
  void jacobian(const State& state, std::span<double> out) const override;
  void variance(std::span<double> out) const override { out[0] = along_sigma_mps_ * along_sigma_mps_, out[1] = across_sigma_mps_ * across_sigma_mps_; }

 private:
  double speed_mps_;
  double cos_;
  double sin_;
  double along_sigma_mps_;
  double across_sigma_mps_;
};

}  // namespace wayfuse
