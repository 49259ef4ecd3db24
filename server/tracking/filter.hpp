#pragma once

#include <memory>

#include "server/tracking/measurement_model.hpp"
#include "server/tracking/motion_model.hpp"
#include "server/tracking/particle_cloud.hpp"
#include "server/tracking/state.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {

/// Where the state's uncertainty is kept: particles, or a mean and a covariance.
///
/// Thread: confined to one session. Never publishes a NaN: an update that would leave nothing is refused.
class Filter {
 public:
  virtual ~Filter() = default;
  virtual std::unique_ptr<Filter> clone() const = 0;
  /// Forgets everything and starts from `about`.
  virtual void start(const GaussianState& about, Random& random) = 0;
  virtual bool started() const = 0;
  virtual void predict(const Motion& motion, Random& random) = 0;
  /// False when the evidence was impossible under every hypothesis: then it is not applied.
  virtual bool update(const MeasurementModel& measurement, Random& random) = 0;
  /// The frame's origin moved: the belief stays where it was in the building.
  virtual void shift(double dx_m, double dy_m) = 0;
  /// Mean and covariance of the present belief.
  virtual GaussianState estimate() const = 0;
  /// Radius about the mean that holds `share` (0..1) of the belief.
  virtual double radius_m(double share) const = 0;
  /// The particles, where there are any.
  virtual ParticleCloud* cloud() { return nullptr; }
  virtual const ParticleCloud* cloud() const { return nullptr; }
};

}  // namespace wayfuse
