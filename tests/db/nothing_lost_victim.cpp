#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include "db/database_directory.hpp"
#include "tests/db/journal.hpp"
#include "tests/db/survey_world.hpp"

// nothing_lost_victim FOLDER CLIENTS [settle]: opens the store in FOLDER and uploads from CLIENTS threads until it is killed;
// with `settle` it only retries what the journals do not know as acknowledged. Says `o` before it opens, `r` and the time
// that took in microseconds when it is ready, `a` at every ack.
namespace wayfuse::testing {
namespace {

constexpr BuildingId kBuilding{7};

void say(const std::string& text) {
  if (::write(STDOUT_FILENO, text.data(), text.size()) < 0) std::_Exit(3);  // nobody listens any more
}

class Client {
 public:
  Client(DatabaseDirectory& directory, const std::filesystem::path& folder, std::uint64_t number)
      : directory_(directory), next_seed_(number * 1'000'000 + 1), file_(folder / ("client-" + std::to_string(number) + ".journal")) {
    read_journal(file_, journal_);
    descriptor_ = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (descriptor_ < 0) std::_Exit(4);
    write("\n");  // ends a line that a kill cut short
    next_seed_ += journal_.size();
  }
  ~Client() { ::close(descriptor_); }

  void retry_unknown() {
    for (auto& [key, entry] : journal_) {
      if (!entry.acked) upload(std::strtoull(key.c_str() + std::strlen("batch-"), nullptr, 10));
    }
  }

  void upload_for_ever() {
    Random random(next_seed_);
    for (std::uint64_t first = next_seed_;; ++next_seed_) {
      upload(next_seed_);
      if (random.below(8) == 0 && next_seed_ > first) upload(first + random.below(next_seed_ - first));  // a retry nobody needed
    }
  }

 private:
  void write(const std::string& line) {
    if (::write(descriptor_, line.data(), line.size()) != static_cast<ssize_t>(line.size())) std::_Exit(5);
  }

  void upload(std::uint64_t seed) {
    const SurveyBatch batch = sample_batch(seed);
    write(sent_line(batch));
    std::promise<Result<SurveyAck>> answer;
    directory_.store(kBuilding, batch, [&](Result<SurveyAck> ack) { answer.set_value(std::move(ack)); });
    const Result<SurveyAck> ack = answer.get_future().get();
    if (!ack) {
      std::fprintf(stderr, "%s\n", to_string(ack.fault()).c_str());
      std::_Exit(6);
    }
    write(acked_line(*ack));
    say("a");
  }

  DatabaseDirectory& directory_;
  std::uint64_t next_seed_;
  const std::filesystem::path file_;
  Journal journal_;
  int descriptor_ = -1;
};

int run(const std::filesystem::path& folder, std::uint64_t clients, bool settle) {
  say("o");
  const auto begin = std::chrono::steady_clock::now();
  auto directory = DatabaseDirectory::open(folder / "data", {});
  if (!directory) {
    std::fprintf(stderr, "%s\n", to_string(directory.fault()).c_str());
    return 1;
  }
  if ((*directory)->buildings().empty()) {
    std::promise<bool> made;
    (*directory)->create_building(sample_building(kBuilding.value), [&](Result<BuildingRecord> r) { made.set_value(r.has_value()); });
    if (!made.get_future().get()) return 2;
  }
  const auto took = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - begin);
  say("r" + std::to_string(took.count()) + "\n");
  std::vector<std::thread> threads;
  for (std::uint64_t number = 1; number <= clients; ++number) {
    threads.emplace_back([&, number] {
      Client client(**directory, folder, number);
      client.retry_unknown();
      if (!settle) client.upload_for_ever();
    });
  }
  for (std::thread& thread : threads) thread.join();
  return 0;
}

}  // namespace
}  // namespace wayfuse::testing

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  return wayfuse::testing::run(argv[1], std::strtoull(argv[2], nullptr, 10), argc > 3 && std::strcmp(argv[3], "settle") == 0);
}
