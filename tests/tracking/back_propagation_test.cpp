#include "server/tracking/back_propagation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace wayfuse {
namespace {

std::vector<TrainingSample> bent_line(int count, Random& random) {
  std::vector<TrainingSample> samples;
  for (int i = 0; i < count; ++i) {
    TrainingSample sample;
    for (double& input : sample.inputs) input = 3.0 * random.normal();
    sample.residual = 2.0 * std::sin(0.5 * sample.inputs[0]) + 0.5 * sample.inputs[4] + 1.0;
    samples.push_back(sample);
  }
  return samples;
}

TEST(BackPropagation, GradientEqualsTheNumericOne) {
  Random random(3);
  const auto samples = bent_line(20, random);
  BackPropagation network = train(samples, {.iterations = 5}, random);
  const auto slope = gradient(network, samples[0]);
  constexpr double kStep = 1e-6;
  for (std::size_t i = 0; i < network.hidden.size(); ++i) {
    BackPropagation above = network, below = network;
    above.hidden[i] += kStep;
    below.hidden[i] -= kStep;
    EXPECT_NEAR(slope.hidden[i], (gradient(above, samples[0]).half_squared - gradient(below, samples[0]).half_squared) / (2 * kStep), 1e-6);
  }
  for (std::size_t i = 0; i < network.output.size(); ++i) {
    BackPropagation above = network, below = network;
    above.output[i] += kStep;
    below.output[i] -= kStep;
    EXPECT_NEAR(slope.output[i], (gradient(above, samples[0]).half_squared - gradient(below, samples[0]).half_squared) / (2 * kStep), 1e-6);
  }
}

TEST(BackPropagation, LearnsWhatALineCannot) {
  Random random(3);
  const auto learn = bent_line(400, random), judge = bent_line(200, random);
  const BackPropagation network = train(learn, {}, random);
  double error2 = 0, spread2 = 0;
  for (const auto& sample : judge) {
    error2 += std::pow(sample.residual - network(sample.inputs), 2);
    spread2 += std::pow(sample.residual - 1.0, 2);
  }
  EXPECT_LT(error2, 0.1 * spread2);  // nine tenths of the variance explained on samples it never saw
}

TEST(BackPropagation, NeverAnswersBeyondWhatItWasShown) {
  Random random(3);
  const auto samples = bent_line(100, random);
  const BackPropagation network = train(samples, {.iterations = 200}, random);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double wild : {1e300, -1e300, kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    const double answer = network({wild, wild, wild, wild, wild, wild});
    EXPECT_LE(std::abs(answer), network.most);
  }
}

TEST(BackPropagation, SameSeedSameNetwork) {
  Random data(3), one(7), two(7);
  const auto samples = bent_line(50, data);
  EXPECT_EQ(train(samples, {.iterations = 50}, one), train(samples, {.iterations = 50}, two));
}

}  // namespace
}  // namespace wayfuse
