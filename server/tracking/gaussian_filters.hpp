#pragma once

#include <memory>

#include "server/tracking/filter.hpp"

namespace wayfuse {

/// A belief kept as mean and covariance. Measurements without a Gaussian form are refused.
class GaussianFilter : public Filter {
 public:
  explicit GaussianFilter(std::shared_ptr<const MotionModel> motion) : motion_(std::move(motion)) {}
  void start(const GaussianState& about, Random& random) override;
  bool started() const override { return started_; }
  void shift(double dx_m, double dy_m) override { belief_.mean.x_m += dx_m, belief_.mean.y_m += dy_m; }
  GaussianState estimate() const override { return belief_; }
  double radius_m(double share) const override;

 protected:
  /// Takes the new belief unless it holds a NaN; the covariance is made symmetric.
  bool take(const GaussianState& belief);

  std::shared_ptr<const MotionModel> motion_;
  GaussianState belief_;
  bool started_ = false;
};

/// Kalman filter [P4 eqs. 1-7]; on models that are not linear the extended Kalman filter [P5], linearised at the mean.
///
/// Joseph's form keeps the covariance positive.
class ExtendedKalmanFilter final : public GaussianFilter {
 public:
  using GaussianFilter::GaussianFilter;
  std::unique_ptr<Filter> clone() const override { return std::make_unique<ExtendedKalmanFilter>(*this); }
  void predict(const Motion& motion, Random& random) override;
  bool update(const MeasurementModel& measurement, Random& random) override;
};

/// No memory: the newest fix as it is, moved on by the motion model. What a filter is compared with. Measurements of anything but the
/// place are refused.
class NewestFixFilter final : public GaussianFilter {
 public:
  using GaussianFilter::GaussianFilter;
  std::unique_ptr<Filter> clone() const override { return std::make_unique<NewestFixFilter>(*this); }
  void predict(const Motion& motion, Random& random) override;
  bool update(const MeasurementModel& measurement, Random& random) override;
};

}  // namespace wayfuse
