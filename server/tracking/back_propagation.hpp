#pragma once

#include <array>
#include <span>
#include <vector>

#include "wayfuse/proto/random.hpp"

namespace wayfuse {

struct BackPropagationSettings {
  int iterations = 5000;           ///< over the whole training set, at most [P4]
  double enough_error = 0.01;      ///< mean squared error, normalised, that ends training early [P4]
  double rate = 0.02;
  double momentum = 0.9;
};

/// A three-layer network, 6 inputs, 8 hidden (tanh), 1 linear output: one per axis [P4].
///
/// Inputs: correction X_k - X_{k,k-1} (2), gain K condensed to its diagonal (2), innovation Z_k - H X_{k,k-1} (2). Inputs and
/// output are scaled by what the training set spans; an output is never larger than the largest residual it was shown.
struct BackPropagation {
  static constexpr int kInputs = 6;
  static constexpr int kHidden = 8;
  using Inputs = std::array<double, kInputs>;

  std::array<double, kInputs> input_mean{};
  std::array<double, kInputs> input_scale{};
  double output_mean = 0.0;
  double output_scale = 1.0;
  double most = 0.0;                                       ///< largest |residual| of the training set
  std::array<double, kHidden*(kInputs + 1)> hidden{};      ///< kHidden x (kInputs + 1), bias last
  std::array<double, kHidden + 1> output{};                ///< bias last

  double operator()(const Inputs& inputs) const;
  bool operator==(const BackPropagation&) const = default;
};

struct TrainingSample {
  BackPropagation::Inputs inputs;
  double residual = 0.0;           ///< truth minus estimate on the network's axis
};

/// Back propagation over the whole set with momentum. `samples` holds at least one. Same seed, same network.
BackPropagation train(std::span<const TrainingSample> samples, const BackPropagationSettings& settings, Random& random);

/// Gradient of half the squared normalised error of one sample by hidden and output weights, for tests.
struct BackPropagationGradient {
  std::array<double, BackPropagation::kHidden*(BackPropagation::kInputs + 1)> hidden{};
  std::array<double, BackPropagation::kHidden + 1> output{};
  double half_squared = 0.0;
};
BackPropagationGradient gradient(const BackPropagation& network, const TrainingSample& sample);

}  // namespace wayfuse
