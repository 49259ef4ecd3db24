#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "tests/db/campaigns.hpp"

// store_campaign kills|power [ROUNDS] [SEED]: the long runs of the store's promises, with a progress display.
namespace {

using namespace wayfuse::testing;  // NOLINT

void show(std::uint64_t done, std::uint64_t of) {
  if (!isatty(STDERR_FILENO) && done != of) return;
  std::fprintf(stderr, "\r%llu of %llu", static_cast<unsigned long long>(done), static_cast<unsigned long long>(of));
  if (done == of) std::fprintf(stderr, "\n");
}

int verdict(const std::vector<std::string>& losses) {
  for (const std::string& loss : losses) std::printf("LOST  %s\n", loss.c_str());
  std::printf("%s\n", losses.empty() ? "nothing acknowledged was lost" : "FAILED");
  return losses.empty() ? 0 : 1;
}

int kills(std::uint64_t rounds, std::uint64_t seed) {
  const KillFigures figures = run_kill_campaign(rounds, seed, WAYFUSE_VICTIM, WAYFUSE_CHECKER, show);
  std::printf("kill -9 %llu times (%llu before ready), %llu uploads acknowledged; ready after %.1f ms (median), %.1f ms (worst)\n",
              static_cast<unsigned long long>(figures.kills), static_cast<unsigned long long>(figures.killed_before_ready),
              static_cast<unsigned long long>(figures.acked), figures.ready_median_ms, figures.ready_worst_ms);
  return verdict(figures.losses);
}

int power(std::uint64_t rounds, std::uint64_t seed) {
  const PowerFigures full = run_power_campaign(rounds, seed, false, show);
  const PowerFigures normal = run_power_campaign(rounds, seed, true, show);
  std::printf("power cut %llu times: %llu uploads acknowledged, %llu unanswered\n", static_cast<unsigned long long>(full.cuts),
              static_cast<unsigned long long>(full.acked), static_cast<unsigned long long>(full.unknown));
  std::printf("control with synchronous=NORMAL: %llu of %llu cuts lost something acknowledged\n",
              static_cast<unsigned long long>(normal.lossy_cuts), static_cast<unsigned long long>(normal.cuts));
  if (normal.lossy_cuts == 0) std::printf("VOID: the control must lose some\n");
  return normal.lossy_cuts == 0 ? 1 : verdict(full.losses);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const auto number = [&](int position, std::uint64_t otherwise) {
    return argc > position ? std::strtoull(argv[position], nullptr, 10) : otherwise;
  };
  if (what == "kills") return kills(number(2, 1000), number(3, 1));
  if (what == "power") return power(number(2, 200), number(3, 1));
  std::fprintf(stderr, "usage: store_campaign kills|power [ROUNDS] [SEED]\n");
  return 2;
}
