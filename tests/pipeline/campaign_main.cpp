#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "tests/pipeline/odd_evidence.hpp"

// evidence_campaign [INPUTS] [SEED]: odd evidence to every preset, every published position looked at. 10,000,000 inputs if not said.
int main(int argc, char** argv) {
  const std::uint64_t inputs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  if (inputs == 0) {
    std::fprintf(stderr, "evidence_campaign [INPUTS] [SEED]: INPUTS is a positive number\n");
    return 2;
  }
  const auto figures = wayfuse::testing::run_odd_evidence(inputs, seed, [](std::uint64_t done, std::uint64_t of) {
    if (!isatty(STDERR_FILENO) && done != of) return;
    std::fprintf(stderr, "\r%llu of %llu", static_cast<unsigned long long>(done), static_cast<unsigned long long>(of));
    if (done == of) std::fprintf(stderr, "\n");
  });
  std::printf("%llu inputs, %llu positions published, seed %llu: %s\n", static_cast<unsigned long long>(figures.inputs),
              static_cast<unsigned long long>(figures.positions), static_cast<unsigned long long>(seed),
              figures.fault.empty() ? "all of them sound" : figures.fault.c_str());
  return figures.fault.empty() ? 0 : 1;
}
