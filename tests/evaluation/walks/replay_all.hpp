#pragma once

#include "tests/evaluation/walks/replay.hpp"

namespace wayfuse {

struct ReplayOptions {
  std::vector<std::string> pipelines;
  std::uint64_t seed = 1;
  unsigned threads = 1;
};

/// Every walk under every pipeline, `dead-reckoning` on the `direct` way; the answers do not depend on the number of threads.
Result<std::vector<PipelineRun>> replay_all(const ReplayOptions& options, const WalkReplay& usual, const WalkReplay& direct,
                                            const ScoredData& data);

}  // namespace wayfuse
