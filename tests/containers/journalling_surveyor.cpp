// Surveyors that upload without end and write down what they sent and what was acknowledged, for nothing_lost_checker.
//
//   journalling_surveyor URL FOLDER BUILDING CLIENTS [settle]
//
// Until SIGTERM each client uploads one batch after another, comes back after every break and retries what it does not know
// as acknowledged under the same key. With `settle` it only retries, and leaves with 0 once everything is acknowledged.
// WAYFUSE_KEY and WAYFUSE_AUTHORITY as for the command line. At the end it says what it did, as one JSON object.
#include <poll.h>
#include <signal.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/db/journal.hpp"
#include "tests/db/survey_world.hpp"
#include "tests/integration/raw_client.hpp"

namespace wayfuse::testing {
namespace {

std::atomic<bool> leaving{false};
std::atomic<unsigned> batches_sent{0}, batches_acked{0}, batches_refused{0}, connections{0};

constexpr int kBetweenBatchesMs = 20;   // a surveyor, not a flood
constexpr int kBetweenTriesMs = 200;
constexpr int kSettleTries = 300;       // a minute

void pause(int milliseconds) {
  ::poll(nullptr, 0, milliseconds);
}

struct Task {
  Endpoint where;
  std::string key;
  std::uint64_t building;
};

// The wire rounds: what was sent is what it says.
SurveyBatch as_sent(const SurveyBatch& batch) {
  const auto read = decode_client_message(encode(ClientMessage(batch), Encoding::kCbor), Encoding::kCbor);
  if (!read) throw std::runtime_error("an own batch does not decode: " + to_string(read.fault()));
  return std::get<SurveyBatch>(*read);
}

class Client {
 public:
  Client(const Task& task, const std::string& folder, std::uint64_t number)
      : task_(task), next_seed_(number * 1'000'000 + 1), file_(folder + "/client-" + std::to_string(number) + ".journal") {
    read_journal(file_, journal_);
    next_seed_ += journal_.size();
    for (const auto& [name, entry] : journal_) {
      if (!entry.acked) unknown_.push_back(std::strtoull(name.c_str() + std::strlen("batch-"), nullptr, 10));
    }
    out_.open(file_, std::ios::app);
    out_ << '\n';  // ends a line that a kill cut short
  }

  void upload_until_told() {
    while (!leaving) {
      if (unknown_.empty()) unknown_.push_back(next_seed_++);
      if (!upload(unknown_.back())) continue;
      unknown_.pop_back();
      pause(kBetweenBatchesMs);
    }
  }

  bool settle() {
    for (int tries = 0; !unknown_.empty() && tries < kSettleTries; ++tries) {
      if (upload(unknown_.back())) unknown_.pop_back();
    }
    return unknown_.empty();
  }

 private:
  // True = acknowledged. Otherwise it is not known, and the connection is given up where it did not answer.
  bool upload(std::uint64_t seed) {
    if (!connected()) return pause(kBetweenTriesMs), false;
    const SurveyBatch batch = as_sent(sample_batch(seed));
    out_ << sent_line(batch) << std::flush;
    ++batches_sent;
    if (socket_->send(batch)) {
      while (const auto message = socket_->receive(10)) {
        if (const auto* ack = std::get_if<SurveyAck>(&*message)) {
          out_ << acked_line(*ack) << std::flush;
          ++batches_acked;
          return true;
        }
        if (const auto* report = std::get_if<FaultReport>(&*message)) {
          ++batches_refused;
          std::fprintf(stderr, "refused: %s\n", to_string(report->fault).c_str());
          pause(kBetweenTriesMs);
          return false;
        }
      }
    }
    socket_.reset();
    return false;
  }

  bool connected() {
    if (socket_) return true;
    socket_ = std::make_unique<RawWebsocket>(task_.where, task_.key, kSubprotocolCbor);
    Hello hello;
    hello.role = Role::kSurvey;
    hello.building = BuildingId{task_.building};
    hello.device_model = "Journalling surveyor";
    if (socket_->status() == 101 && socket_->send(hello) && socket_->expect<Welcome>()) return ++connections, true;
    socket_.reset();
    return false;
  }

  const Task& task_;
  std::uint64_t next_seed_;
  std::string file_;
  Journal journal_;
  std::vector<std::uint64_t> unknown_;
  std::ofstream out_;
  std::unique_ptr<RawWebsocket> socket_;
};

int run(const Task& task, const std::string& folder, std::uint64_t clients, bool settle) {
  std::atomic<bool> whole{true};
  std::vector<std::thread> threads;
  for (std::uint64_t number = 1; number <= clients; ++number) {
    threads.emplace_back([&, number] {
      Client client(task, folder, number);
      if (settle) {
        if (!client.settle()) whole = false;
      } else {
        client.upload_until_told();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::printf("{\"sent\":%u,\"acked\":%u,\"refused\":%u,\"connections\":%u}\n", batches_sent.load(), batches_acked.load(),
              batches_refused.load(), connections.load());
  return whole ? 0 : 1;
}

std::string in_environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

}  // namespace
}  // namespace wayfuse::testing

int main(int argc, char** argv) {
  using namespace wayfuse::testing;
  if (argc < 5) return std::fputs("usage: journalling_surveyor URL FOLDER BUILDING CLIENTS [settle]\n", stderr), 2;
  ::signal(SIGTERM, [](int) { leaving = true; });
  const Task task{{argv[1], in_environment("WAYFUSE_AUTHORITY")}, in_environment("WAYFUSE_KEY"), std::strtoull(argv[3], nullptr, 10)};
  return run(task, argv[2], std::strtoull(argv[4], nullptr, 10), argc > 5 && std::strcmp(argv[5], "settle") == 0);
}
