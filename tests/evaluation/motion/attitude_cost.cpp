#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/evaluation/motion/attitude_score.hpp"

// Feeds the first N samples of a BROAD trial, every n-th one, to one estimator and nothing else: for callgrind.
int main(int argc, char** argv) {
  using namespace wayfuse;
  if (argc != 5) {
    std::fprintf(stderr, "usage: %s TRIAL.csv ESTIMATOR SAMPLES EVERY\n", argv[0]);
    return 2;
  }
  const auto trial = read_broad_trial(argv[1]);
  if (!trial) {
    std::fprintf(stderr, "%s\n", to_string(trial.fault()).c_str());
    return 2;
  }
  const std::size_t count = std::strtoul(argv[3], nullptr, 10), every = std::strtoul(argv[4], nullptr, 10);
  for (const NamedEstimator& estimator : measured_estimators()) {
    if (estimator.name != argv[2]) continue;
    const auto made = estimator.make();
    for (std::size_t i = 0; i < count && i * every < trial->samples.size(); ++i) made->feed(trial->samples[i * every]);
    return 0;
  }
  std::fprintf(stderr, "no estimator '%s'\n", argv[2]);
  return 2;
}
