#pragma once

#include "server/tracking/particle_cloud.hpp"
#include "server/tracking/state.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {

/// What is known of one interval, in the pipeline's frame. Made by the pipeline from motion reports.
struct Motion {
  double dt_s = 0.0;               ///< > 0: the pipeline drops intervals that do not advance
  double heading_rad = 0.0;        ///< from the x axis, counter-clockwise
  double heading_sigma_rad = 0.0;
  double distance_m = 0.0;
  double distance_sigma_m = 0.0;
  double spread_m = 0.0;           ///< extra isotropic sigma of the displacement: gaps without any report
  int steps = 0;
  bool at_rest = false;
};

/// How a walker gets from one moment to the next. Immutable; a call takes the whole cloud.
class MotionModel {
 public:
  virtual ~MotionModel() = default;

  /// Optional columns of the cloud this model moves.
  virtual unsigned columns() const = 0;
  /// Whether heading or distance of the motion are used as a control: then they must not be fed as a measurement too.
  virtual bool uses_heading() const = 0;
  virtual bool uses_distance() const = 0;

  /// Draws the optional columns of a fresh particle set (x, y and velocity are set by the filter).
  virtual void start(ParticleCloud& /*cloud*/, Random& /*random*/) const {}
  /// Moves every particle, each with its own noise.
  virtual void propagate(ParticleCloud& cloud, const Motion& motion, Random& random) const = 0;

  /// The same without noise, its Jacobian by the state, and the covariance of the noise: for the Kalman family.
  virtual State propagate(const State& state, const Motion& motion) const = 0;
  virtual StateMatrix jacobian(const State& state, const Motion& motion) const = 0;
  virtual StateMatrix noise(const State& state, const Motion& motion) const = 0;
};

}  // namespace wayfuse
