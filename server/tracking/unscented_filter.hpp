#pragma once

#include "server/tracking/gaussian_filters.hpp"

namespace wayfuse {

struct UnscentedSettings {
  double alpha = 0.5;              ///< spread of the sigma points about the mean; smaller stays nearer
  double beta = 2.0;               ///< 2 is best for Gaussians
  double kappa = 0.0;
};

/// Unscented Kalman filter (Julier and Uhlmann 1997; scaled as Wan and van der Merwe 2000) [P5].
///
/// Nine sigma points of the 4-vector go through the same model functions the other filters use; additive noise; points are
/// drawn anew before every update. Equal to the Kalman filter on linear models. Angles are averaged as differences from the mean point.
class UnscentedKalmanFilter final : public GaussianFilter {
 public:
  UnscentedKalmanFilter(std::shared_ptr<const MotionModel> motion, const UnscentedSettings& settings)
      : GaussianFilter(std::move(motion)), settings_(settings) {}
  std::unique_ptr<Filter> clone() const override { return std::make_unique<UnscentedKalmanFilter>(*this); }
  void predict(const Motion& motion, Random& random) override;
  bool update(const MeasurementModel& measurement, Random& random) override;

 private:
  UnscentedSettings settings_;
};

}  // namespace wayfuse
