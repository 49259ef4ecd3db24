#pragma once

#include "server/tracking/resampler.hpp"

namespace wayfuse {

/// N independent draws, Pr(x* = x_i) = w_i [P1 eqs. 15-16]. The plainest and the noisiest.
class MultinomialResampler final : public Resampler {
 public:
  void resample(ParticleCloud& cloud, Random& random) const override;
};

/// One uniform draw, N evenly spaced pointers (Kitagawa 1996): particle i is taken floor or ceil of N w_i times.
class SystematicResampler final : public Resampler {
 public:
  void resample(ParticleCloud& cloud, Random& random) const override;
};

/// floor(N w_i) copies for certain, the rest drawn from what is left (Liu and Chen 1998).
class ResidualResampler final : public Resampler {
 public:
  void resample(ParticleCloud& cloud, Random& random) const override;
};

struct PerturbingSettings {
  double share = 0.3;     ///< of the particles that are moved, 0..1
  double sigma_m = 1.0;   ///< of the move, on each axis
};

/// Systematic, then a random offset to a share of the particles: the improved SIR of [P3], best at 30 %. On top of this resampler only
/// (README, Decisions).
class PerturbingResampler final : public Resampler {
 public:
  explicit PerturbingResampler(const PerturbingSettings& settings) : settings_(settings) {}
  void resample(ParticleCloud& cloud, Random& random) const override;

 private:
  PerturbingSettings settings_;
};

}  // namespace wayfuse
