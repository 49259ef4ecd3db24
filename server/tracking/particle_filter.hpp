#pragma once

#include <memory>

#include "server/tracking/filter.hpp"
#include "server/tracking/resampler.hpp"

namespace wayfuse {

struct ParticleFilterSettings {
  int particles = 500;             ///< 10..100000; the error falls with its root, the cost grows with it
  double resample_below = 0.5;     ///< share of the particles the effective size may fall to; 1 = after every update
};

/// Sequential importance resampling [P1 eqs. 11-16]. Log weights throughout: they never underflow.
class ParticleFilter final : public Filter {
 public:
  ParticleFilter(const ParticleFilterSettings& settings, std::shared_ptr<const MotionModel> motion,
                 std::shared_ptr<const Resampler> resampler);
  std::unique_ptr<Filter> clone() const override { return std::make_unique<ParticleFilter>(*this); }
  void start(const GaussianState& about, Random& random) override;
  bool started() const override { return started_; }
  void shift(double dx_m, double dy_m) override { cloud_.shift(dx_m, dy_m); }
  void predict(const Motion& motion, Random& random) override;
  bool update(const MeasurementModel& measurement, Random& random) override;
  GaussianState estimate() const override;
  double radius_m(double share) const override;
  ParticleCloud* cloud() override { return &cloud_; }
  const ParticleCloud* cloud() const override { return &cloud_; }

 private:
  ParticleFilterSettings settings_;
  std::shared_ptr<const MotionModel> motion_;
  std::shared_ptr<const Resampler> resampler_;
  ParticleCloud cloud_;
  Scratch<float> gained_;          // log-likelihood of the newest measurement
  bool started_ = false;
};

}  // namespace wayfuse
