#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/fixtures/virtual_scheduler.hpp"
#include "wayfuse/proto/codec.hpp"
#include "wayfuse/sdk/client.hpp"

namespace wayfuse {

/// The far end of one connection attempt, played by the test.
struct FarEnd {
  Link::Events events;
  Encoding encoding = Encoding::kCbor;
  std::vector<ClientMessage> heard;
  std::size_t room = ~std::size_t{0};  ///< frames the link still takes
  bool closed = false;                 ///< by the client
  bool destroyed = false;

  void open() { events.opened(encoding); }
  void say(const ServerMessage& message) { events.received(encode(message, encoding)); }
  void drop(std::string_view reason = "reset by the test") { events.closed(reason); }

  template <typename Body>
  std::vector<Body> all() const {
    std::vector<Body> found;
    for (const ClientMessage& message : heard) {
      if (const auto* body = std::get_if<Body>(&message)) found.push_back(*body);
    }
    return found;
  }
  std::vector<std::uint64_t> sequences() const {
    std::vector<std::uint64_t> numbers;
    for (const SampleBatch& batch : all<SampleBatch>()) {
      for (const Sample& sample : batch.samples) numbers.push_back(sample.sequence);
    }
    return numbers;
  }
};

class ScriptedLink final : public Link {
 public:
  explicit ScriptedLink(std::shared_ptr<FarEnd> far) : far_(std::move(far)) {}
  ~ScriptedLink() override { far_->destroyed = true; }
  void open(Events events) override { far_->events = std::move(events); }
  bool send(std::string frame) override {
    EXPECT_FALSE(far_->closed) << "sent after close";
    EXPECT_LE(frame.size(), Limits::kMessageBytes);
    if (far_->room == 0) return false;
    --far_->room;
    auto message = decode_client_message(frame, far_->encoding);
    EXPECT_TRUE(message) << to_string(message.fault());
    if (message) far_->heard.push_back(std::move(message).value());
    return true;
  }
  void close() override { far_->closed = true; }

 private:
  std::shared_ptr<FarEnd> far_;
};

/// One client on a virtual clock, with everything it ever told.
class ClientTest : public testing::Test {
 protected:
  ClientTest() { settings.token = [this] { return ++tokens_asked, token; }; }

  void make(Role role = Role::kTrack) {
    settings.role = role;
    if (settings.building.value == 0 && role != Role::kTrack) settings.building = BuildingId{1};
    ClientEvents events;
    events.position = [this](const Position& position) { positions.push_back(position); };
    events.welcomed = [this](const Welcome& welcome) { welcomes.push_back(welcome); };
    events.survey_stored = [this](const SurveyAck& ack) { stored.push_back(ack.idempotency_key); };
    events.fault = [this](const FaultReport& report) {
      faults.push_back(report);
      if (on_fault) on_fault();
    };
    events.state_changed = [this](ClientState state) {
      states.push_back(state);
      if (on_state) on_state(state);
    };
    events.samples_lost = [this](std::uint64_t first, std::uint64_t last) { lost.emplace_back(first, last); };
    events.disconnected = [this](std::string_view reason) { reasons.emplace_back(reason); };
    client = std::make_unique<Client>(
        settings, std::move(events),
        [this]() -> std::unique_ptr<Link> {
          connected_at.push_back(clock.now());
          ends.push_back(std::make_shared<FarEnd>());
          return std::make_unique<ScriptedLink>(ends.back());
        },
        clock, Random(seed));
  }

  FarEnd& far() { return *ends.back(); }

  static Welcome fresh(std::string session = "s1", std::uint64_t epoch = 7) {
    Welcome welcome;
    welcome.session = std::move(session);
    welcome.tracked = "t1";
    welcome.epoch = epoch;
    welcome.building = BuildingId{1};
    welcome.building_name = "hall";
    welcome.pipeline = "p1";
    welcome.keep_alive = std::chrono::seconds(20);
    welcome.sample_ring = std::chrono::seconds(60);
    return welcome;
  }
  static Welcome recovered(std::uint64_t applied, std::string session = "s1", std::uint64_t epoch = 7) {
    Welcome welcome = fresh(std::move(session), epoch);
    welcome.recovered = true;
    welcome.applied_through = applied;
    return welcome;
  }

  void start_streaming(Role role = Role::kTrack) {
    make(role);
    client->start();
    far().open();
    far().say(fresh());
    ASSERT_EQ(client->state(), ClientState::kStreaming);
  }

  MotionReport step() {
    MotionReport report;
    report.time = clock.now();
    report.interval = std::chrono::milliseconds(500);
    report.steps = 1;
    report.step_length_m = 0.7;
    return report;
  }
  MotionReport rest() {
    MotionReport report = step();
    report.steps = 0;
    report.step_length_m = 0;
    report.at_rest = true;
    return report;
  }
  void walk(int steps) {
    for (int i = 0; i < steps; ++i) ASSERT_TRUE(client->send(step()));
  }
  /// Runs until the next connection attempt; false = none within `most`.
  bool wait_for_attempt(Duration most = std::chrono::minutes(20)) {
    const std::size_t before = ends.size();
    for (Duration waited{0}; waited < most && ends.size() == before; waited += std::chrono::milliseconds(1)) {
      clock.run_for(std::chrono::milliseconds(1));
    }
    return ends.size() > before;
  }
  void run(double seconds_s) { clock.run_for(from_seconds(seconds_s)); }

  VirtualScheduler clock;
  ClientSettings settings;
  std::uint64_t seed = 1;
  std::string token = "key";
  int tokens_asked = 0;
  std::vector<std::shared_ptr<FarEnd>> ends;
  std::vector<PhoneTime> connected_at;
  std::vector<ClientState> states;
  std::vector<Position> positions;
  std::vector<Welcome> welcomes;
  std::vector<std::string> stored;
  std::vector<FaultReport> faults;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> lost;
  std::vector<std::string> reasons;
  std::function<void()> on_fault;
  std::function<void(ClientState)> on_state;
  std::unique_ptr<Client> client;
};

/// 1..last, or first..last.
inline std::vector<std::uint64_t> numbers(std::uint64_t first, std::uint64_t last) {
  std::vector<std::uint64_t> all;
  for (std::uint64_t number = first; number <= last; ++number) all.push_back(number);
  return all;
}

}  // namespace wayfuse
