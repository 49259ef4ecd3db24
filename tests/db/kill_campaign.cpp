#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "tests/db/campaigns.hpp"
#include "tests/db/survey_world.hpp"

extern char** environ;

namespace wayfuse::testing {
namespace {

constexpr std::uint64_t kClients = 8;
constexpr std::uint64_t kKillsPerStore = 25;  // then a new store, so that checking stays cheap

// A program under our hand: what it says comes through a pipe.
class Program {
 public:
  explicit Program(std::vector<std::string> words) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe2");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int failed = ::posix_spawn(&process_, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    heard_ = ends[0];
    if (failed != 0) throw std::runtime_error("cannot start " + words[0]);
  }
  ~Program() { ::close(heard_); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// The next character it says; 0 at its end.
  char hear() {
    char said = 0;
    return ::read(heard_, &said, 1) == 1 ? said : '\0';
  }
  void kill() { ::kill(process_, SIGKILL); }
  int wait() {
    int status = 0;
    ::waitpid(process_, &status, 0);
    return status;
  }

 private:
  pid_t process_ = 0;
  int heard_ = -1;
};

class KillCampaign {
 public:
  KillCampaign(std::string victim, std::string checker, std::uint64_t seed)
      : victim_(std::move(victim)), checker_(std::move(checker)), random_(seed) {}

  void one_store(std::uint64_t kills, const Progress& progress, std::uint64_t of) {
    const TemporaryFolder folder;
    for (std::uint64_t i = 0; i < kills; ++i) {
      kill_once(folder);
      ++figures_.kills;
      check(folder, false);
      progress(figures_.kills, of);
    }
    Program settling({victim_, folder.path(), std::to_string(kClients), "settle"});
    listen(settling, UINT64_MAX);
    const int status = settling.wait();
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) figures_.losses.push_back("the store does not come up again");
    check(folder, true);
  }

  KillFigures figures() {
    std::sort(ready_us_.begin(), ready_us_.end());
    if (!ready_us_.empty()) {
      figures_.ready_median_ms = ready_us_[ready_us_.size() / 2] / 1000;
      figures_.ready_worst_ms = ready_us_.back() / 1000;
    }
    return figures_;
  }

 private:
  // Hears acks until there were `enough`; notes how long it took to be ready.
  bool listen(Program& program, std::uint64_t enough) {
    std::uint64_t acks = 0;
    while (acks < enough) {
      const char said = program.hear();
      if (said == '\0') return false;
      if (said == 'a') {
        ++acks;
        ++figures_.acked;
      }
      if (said != 'r') continue;
      std::string number;
      for (char digit = program.hear(); digit != '\n' && digit != '\0'; digit = program.hear()) number += digit;
      ready_us_.push_back(std::strtod(number.c_str(), nullptr));
    }
    return true;
  }

  void kill_once(const TemporaryFolder& folder) {
    Program victim({victim_, folder.path(), std::to_string(kClients)});
    const bool early = random_.below(8) == 0;  // while it opens, recovers or makes its building
    figures_.killed_before_ready += early;
    const bool alive = early ? victim.hear() == 'o' : listen(victim, 1 + random_.below(60));
    victim.kill();
    const int status = victim.wait();
    if (!alive || !WIFSIGNALED(status)) figures_.losses.push_back("round " + std::to_string(figures_.kills) + ": the victim died by itself");
  }

  void check(const TemporaryFolder& folder, bool settled) {
    const std::string database = folder / "data/building-7.sqlite";
    if (!settled && (!std::filesystem::exists(database) || std::filesystem::file_size(database) == 0)) return;  // not made yet
    std::vector<std::string> words = {checker_};
    if (settled) words.emplace_back("--settled");
    words.push_back(database);
    for (std::uint64_t client = 1; client <= kClients; ++client) words.push_back(folder / ("client-" + std::to_string(client) + ".journal"));
    const int status = Program(words).wait();
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) figures_.losses.push_back("round " + std::to_string(figures_.kills) + ": see the checker's words above");
  }

  const std::string victim_;
  const std::string checker_;
  Random random_;
  KillFigures figures_;
  std::vector<double> ready_us_;
};

}  // namespace

KillFigures run_kill_campaign(std::uint64_t kills, std::uint64_t seed, const std::string& victim, const std::string& checker,
                              const Progress& progress) {
  KillCampaign campaign(victim, checker, seed);
  for (std::uint64_t done = 0; done < kills; done += kKillsPerStore) {
    campaign.one_store(std::min(kKillsPerStore, kills - done), progress, kills);
  }
  return campaign.figures();
}

}  // namespace wayfuse::testing
