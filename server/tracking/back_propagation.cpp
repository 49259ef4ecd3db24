#include "server/tracking/back_propagation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace wayfuse {
namespace {

constexpr int kIn = BackPropagation::kInputs;
constexpr int kRow = kIn + 1;
constexpr int kHid = BackPropagation::kHidden;
constexpr double kMostScaled = 5.0;  // inputs far outside the training set are held there: no wild answers

struct Forward {
  std::array<double, kIn> scaled;
  std::array<double, kHid> active;
  double output;
};

Forward forward(const BackPropagation& network, const BackPropagation::Inputs& inputs) {
  Forward pass{};
  for (int i = 0; i < kIn; ++i) {
    pass.scaled[i] = std::clamp((inputs[i] - network.input_mean[i]) / network.input_scale[i], -kMostScaled, kMostScaled);
  }
  pass.output = network.output[kHid];
  for (int h = 0; h < kHid; ++h) {
    double sum = network.hidden[h * kRow + kIn];
    for (int i = 0; i < kIn; ++i) sum += network.hidden[h * kRow + i] * pass.scaled[i];
    pass.active[h] = std::tanh(sum);
    pass.output += network.output[h] * pass.active[h];
  }
  return pass;
}

void scale_to(BackPropagation& network, std::span<const TrainingSample> samples) {
  const auto spread = [&](const auto& value, double& mean, double& scale) {
    const auto n = static_cast<double>(samples.size());
    mean = 0.0;
    for (const auto& sample : samples) mean += value(sample) / n;
    double squares = 0.0;
    for (const auto& sample : samples) squares += (value(sample) - mean) * (value(sample) - mean) / n;
    scale = std::max(std::sqrt(squares), 1e-6);
  };
  for (int i = 0; i < kIn; ++i) {
    spread([i](const TrainingSample& s) { return s.inputs[i]; }, network.input_mean[i], network.input_scale[i]);
  }
  spread([](const TrainingSample& s) { return s.residual; }, network.output_mean, network.output_scale);
  for (const auto& sample : samples) network.most = std::max(network.most, std::abs(sample.residual));
}

}  // namespace

double BackPropagation::operator()(const Inputs& inputs) const {
  const double answer = output_mean + output_scale * forward(*this, inputs).output;
  return std::isfinite(answer) ? std::clamp(answer, -most, most) : 0.0;
}

BackPropagationGradient gradient(const BackPropagation& network, const TrainingSample& sample) {
  const Forward pass = forward(network, sample.inputs);
  const double error = pass.output - (sample.residual - network.output_mean) / network.output_scale;
  BackPropagationGradient slope;
  slope.half_squared = 0.5 * error * error;
  slope.output[kHid] = error;
  for (int h = 0; h < kHid; ++h) {
    slope.output[h] = error * pass.active[h];
    const double back = error * network.output[h] * (1.0 - pass.active[h] * pass.active[h]);
    for (int i = 0; i < kIn; ++i) slope.hidden[h * kRow + i] = back * pass.scaled[i];
    slope.hidden[h * kRow + kIn] = back;
  }
  return slope;
}

BackPropagation train(std::span<const TrainingSample> samples, const BackPropagationSettings& settings, Random& random) {
  assert(!samples.empty());
  BackPropagation network;
  scale_to(network, samples);
  for (double& weight : network.hidden) weight = 0.4 * random.normal();
  for (double& weight : network.output) weight = 0.1 * random.normal();
  decltype(BackPropagation::hidden) hidden_step{};
  decltype(BackPropagation::output) output_step{};
  const double share = 1.0 / static_cast<double>(samples.size());
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    BackPropagationGradient sum;
    for (const TrainingSample& sample : samples) {
      const BackPropagationGradient slope = gradient(network, sample);
      for (std::size_t i = 0; i < slope.hidden.size(); ++i) sum.hidden[i] += share * slope.hidden[i];
      for (std::size_t i = 0; i < slope.output.size(); ++i) sum.output[i] += share * slope.output[i];
      sum.half_squared += share * slope.half_squared;
    }
    if (2.0 * sum.half_squared < settings.enough_error) break;
    const auto step = [&](auto& weights, auto& steps, const auto& slopes) {
      for (std::size_t i = 0; i < weights.size(); ++i) {
        steps[i] = settings.momentum * steps[i] - settings.rate * slopes[i];
        weights[i] += steps[i];
      }
    };
    step(network.hidden, hidden_step, sum.hidden);
    step(network.output, output_step, sum.output);
  }
  return network;
}

}  // namespace wayfuse
