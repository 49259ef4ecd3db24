#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// The store's campaigns: the same code runs short in every test run and long from `./run campaign`.
namespace wayfuse::testing {

using Progress = std::function<void(std::uint64_t done, std::uint64_t of)>;

struct KillFigures {
  std::uint64_t kills = 0;
  std::uint64_t killed_before_ready = 0;
  std::uint64_t acked = 0;
  std::vector<std::string> losses;   ///< each with its round; empty = nothing was lost
  double ready_median_ms = 0.0;      ///< open to ready, over all starts
  double ready_worst_ms = 0.0;
};

/// `kill -9` during 8 parallel uploads, over and over [R4]. After each kill and after each retry the checker program looks.
KillFigures run_kill_campaign(std::uint64_t kills, std::uint64_t seed, const std::string& victim, const std::string& checker,
                              const Progress& progress);

struct PowerFigures {
  std::uint64_t cuts = 0;
  std::uint64_t acked = 0;
  std::uint64_t unknown = 0;
  std::uint64_t lossy_cuts = 0;      ///< cuts that lost something acknowledged, or left the file damaged
  std::vector<std::string> losses;
};

/// Cuts the power of a disk in memory at a random change, once a seed [R5]. With `synchronous_normal` it must lose something.
PowerFigures run_power_campaign(std::uint64_t cuts, std::uint64_t seed, bool synchronous_normal, const Progress& progress);

}  // namespace wayfuse::testing
