#include "tests/evaluation/walks/replay_all.hpp"

#include <atomic>
#include <cstdio>
#include <mutex>
#include <set>
#include <thread>

#include "tests/evaluation/datasets/split.hpp"
#include "tests/evaluation/progress_bar.hpp"

namespace wayfuse {

Result<std::vector<PipelineRun>> replay_all(const ReplayOptions& options, const WalkReplay& usual, const WalkReplay& direct,
                                            const ScoredData& data) {
  std::vector<PipelineRun> runs;
  for (const std::string& name : options.pipelines) {
    const WalkReplay& way = name == "dead-reckoning" ? direct : usual;
    runs.push_back({name, std::string(way.path()), std::vector<Answers>(data.walks.size()),
                    std::vector<std::optional<double>>(data.walks.size())});
  }
  const std::size_t jobs = runs.size() * data.walks.size();
  ProgressBar progress("replaying walks", jobs);
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::optional<Fault> fault;
  std::set<std::string> left_out;
  const auto work = [&] {
    for (std::size_t job = next++; job < jobs; job = next++) {
      PipelineRun& run = runs[job % runs.size()];
      const std::size_t w = job / runs.size();
      const WalkReplay& way = run.pipeline == "dead-reckoning" ? direct : usual;
      auto reply = way.run(data.walks[w].walk, data.instants[w], run.pipeline, options.seed ^ fnv1a(data.walks[w].walk.id));
      if (!reply) {
        const std::lock_guard lock(mutex);
        if (!fault) fault = reply.fault();
        next = jobs;
        return;
      }
      if (reply->refused > 0) {
        const std::lock_guard lock(mutex);
        left_out.insert(data.walks[w].walk.id + ": " + std::to_string(reply->refused) + " samples, the first: " + to_string(*reply->refusal));
      }
      run.walks[w] = std::move(reply->at);
      run.first_fix_s[w] = reply->first_fix_s;
      progress.advance();
    }
  };
  std::vector<std::jthread> threads;
  for (unsigned i = 1; i < options.threads; ++i) threads.emplace_back(work);
  work();
  threads.clear();
  for (const std::string& samples : left_out) std::fprintf(stderr, "left out: %s\n", samples.c_str());
  if (fault) return *fault;
  return runs;
}

}  // namespace wayfuse
