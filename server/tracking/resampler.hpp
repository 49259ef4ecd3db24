#pragma once

#include <memory>

#include "server/tracking/particle_cloud.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {

/// Turns a weighted cloud into an equally weighted one that stands for the same distribution. Immutable.
class Resampler {
 public:
  virtual ~Resampler() = default;
  /// The cloud's weights are normalised on entry and equal on return.
  virtual void resample(ParticleCloud& cloud, Random& random) const = 0;
};

}  // namespace wayfuse
