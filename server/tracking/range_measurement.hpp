#pragma once

#include <array>

#include "server/tracking/measurement_model.hpp"

namespace wayfuse {

/// Distances from known points, each with its own sigma: z_i = |x - a_i| [P3 eq. 3].
///
/// Holds up to 32; of more the caller passes the best. Weighs with a Gaussian whose cost is capped at 4 sigma a range, so that one
/// transmitter behind a wall does not decide alone.
class RangeMeasurement final : public MeasurementModel {
 public:
  struct Range {
    double x_m = 0.0;
    double y_m = 0.0;
    double distance_m = 0.0;
    double sigma_m = 1.0;
  };
  /// Ranges beyond the 32nd are left out.
  void add(const Range& range);
  std::span<const Range> ranges() const { return {ranges_.data(), count_}; }

  void weigh(const ParticleCloud& cloud, std::span<float> log_weight) const override;
  int dimension() const override { return static_cast<int>(count_); }
  void residual(const State& state, std::span<double> out) const override;
  void jacobian(const State& state, std::span<double> out) const override;
  void variance(std::span<double> out) const override;

 private:
  std::array<Range, kMostDimensions> ranges_{};
  std::size_t count_ = 0;
};

}  // namespace wayfuse
