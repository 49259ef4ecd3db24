#pragma once

#include "server/tracking/motion_model.hpp"

namespace wayfuse {

struct StillSettings {
  double wander_m_rts = 0.0;       ///< random walk, metres per root second: larger forgets sooner
};

/// Nothing is known of the motion: the place stays, blurred by a random walk. For Wi-Fi alone.
class StillMotion final : public MotionModel {
 public:
  explicit StillMotion(const StillSettings& settings) : settings_(settings) {}
  unsigned columns() const override { return 0; }
  bool uses_heading() const override { return false; }
  bool uses_distance() const override { return false; }
  void propagate(ParticleCloud& cloud, const Motion& motion, Random& random) const override;
  State propagate(const State& state, const Motion&) const override { return {state.x_m, state.y_m, 0.0, 0.0}; }
  StateMatrix jacobian(const State& state, const Motion& motion) const override;
  StateMatrix noise(const State& state, const Motion& motion) const override;

 private:
  double sigma_m(const Motion& motion) const;
  StillSettings settings_;
};

}  // namespace wayfuse
