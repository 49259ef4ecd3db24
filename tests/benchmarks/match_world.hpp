#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>
#include <memory>
#include <vector>

#include "server/locating/radio_map.hpp"

namespace wayfuse {

constexpr std::size_t kParticles = 1000;
/// CPU time a particle, of an iteration over kParticles of them.
inline benchmark::Counter time_per_particle() {
  return {static_cast<double>(kParticles), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

/// A survey to match against, as wayfuse keeps it and as a dense matrix.
struct MatchWorld {
  std::shared_ptr<const RadioMap> map;
  std::vector<float> dense;        // points x transmitters, -100 = not heard
  std::vector<RssScan> scans;
};

/// Points on a square grid; transmitters fade with distance, so that a point hears some thirty of them. Made once a size.
const MatchWorld& match_world(std::size_t points, std::size_t transmitters);
/// The scan as a row of the dense matrix.
void dense_row(const MatchWorld& world, const RssScan& scan, KnownScan& known, std::vector<float>& row);

}  // namespace wayfuse
