#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "server/buildings/building_keeper.hpp"
#include "server/sessions/session.hpp"
#include "server/sessions/session_world.hpp"
#include "tests/fixtures/scratch_folder.hpp"
#include "tests/fixtures/still_clock.hpp"
#include "tests/locating/plan.hpp"

namespace wayfuse {

/// What a conversation said, and how it was ended.
class HeardOutput final : public SessionOutput {
 public:
  void send(const ServerMessage& message) override { said.push_back(message); }
  bool congested() const override { return is_congested; }
  void close(const Fault& reason) override { closed = reason; }
  void finish() override { finished = true; }

  template <typename Body>
  std::vector<Body> all() const {
    std::vector<Body> found;
    for (const ServerMessage& message : said) {
      if (const auto* body = std::get_if<Body>(&message)) found.push_back(*body);
    }
    return found;
  }
  template <typename Body>
  Body last() const {
    const auto found = all<Body>();
    EXPECT_FALSE(found.empty());
    return found.empty() ? Body{} : found.back();
  }

  std::vector<ServerMessage> said;
  std::optional<Fault> closed;
  bool finished = false;
  bool is_congested = false;
};

/// One connection of a test.
struct Caller {
  HeardOutput output;
  std::shared_ptr<Conversation> conversation;

  void say(ClientMessage message) { conversation->receive(std::move(message)); }
};

/// The rooms a session lives in, on a still clock, over a real store without threads. Building 1 is a hall:
///
///     A....B....C      4 m a character
///     ...........
///     D....E....F
class SessionHouse {
 public:
  explicit SessionHouse(std::uint64_t seed = 1, SessionShelfSettings settings = {})
      : random(seed), sessions(77, names(), settings) {
    DatabaseDirectory::Options options;
    options.own_thread = false;
    auto opened = DatabaseDirectory::open(folder.path(), options);
    if (!opened) throw std::runtime_error(to_string(opened.fault()));
    store = *std::move(opened);
    keeper = std::make_unique<BuildingKeeper>(*store, buildings, [](std::function<void()> task) { task(); });
    world.reset(new SessionWorld{.clock = clock,
                                 .buildings = buildings,
                                 .sessions = sessions,
                                 .board = board,
                                 .store = *store,
                                 .counters = counters,
                                 .survey_changed = [this](BuildingId id) { keeper->refresh(id); },
                                 .settings = {}});
  }

  static Plan hall() { return Plan({"A....B....C", "...........", "D....E....F"}, 4.0); }

  /// Adds a building with the hall's survey, or an empty one.
  BuildingId add_building(const std::string& name, bool surveyed, std::uint64_t shifted_bssid = 0) {
    BuildingRecord record;
    record.name = name;
    record.pipeline = "nn";
    BuildingId id;
    store->create_building(record, [&](Result<BuildingRecord> made) { id = made.value().id; });
    if (surveyed) survey(id, shifted_bssid);
    keeper->refresh(id);
    return id;
  }
  void survey(BuildingId id, std::uint64_t shifted_bssid = 0) {
    SurveyBatch batch{"survey-" + std::to_string(++surveys), hall().survey(1)};
    for (auto& point : batch.points) {
      point.device_model = "plan";
      for (auto& scan : point.scans) {
        for (auto& reading : scan.readings) reading.bssid.value += shifted_bssid;
      }
    }
    store->store(id, batch, [&](Result<SurveyAck> ack) { EXPECT_TRUE(ack) << to_string(ack.fault()); });
  }

  Caller call(std::optional<Rights> rights = everything()) {
    Caller caller;
    call(caller, std::move(rights));
    return caller;
  }
  void call(Caller& caller, std::optional<Rights> rights = everything()) {
    caller.conversation = begin_conversation(
        *world, caller.output, [this](std::function<void()> task) { posted.push_back(std::move(task)); }, std::move(rights),
        [](std::string_view token) -> Result<Rights> {
          if (token == "good") return everything();
          return Fault{FaultCode::kNotAuthenticated, "token", "the key is not valid"};
        });
  }
  void run_posted() {
    while (!posted.empty()) {
      auto task = std::move(posted.front());
      posted.pop_front();
      task();
    }
  }
  static Rights everything() {
    return {.key_id = 5, .track = true, .survey = true, .observe = true, .building = {}, .expires_at = {}};
  }

  ScratchFolder folder;
  StillClock clock;
  Random random;
  std::unique_ptr<DatabaseDirectory> store;
  BuildingShelf buildings;
  std::unique_ptr<BuildingKeeper> keeper;
  SessionShelf sessions;
  LiveBoard board;
  SessionCounters counters;
  std::unique_ptr<SessionWorld> world;
  std::deque<std::function<void()>> posted;
  int surveys = 0;

 private:
  SessionNames names() {
    return {[this] { return "secret-" + std::to_string(random.bits()); },
            [this] { return "phone-" + std::to_string(random.below(1'000'000)); }, [this] { return random.bits(); }};
  }
};

inline PhoneTime at(double time_s) {
  return PhoneTime{from_seconds(time_s)};
}

inline MotionReport step_at(double time_s, double heading_rad = 0.0) {
  MotionReport motion;
  motion.time = at(time_s);
  motion.interval = from_seconds(0.5);
  motion.heading = Heading::from_radians(heading_rad);
  motion.heading_sigma_rad = 0.1;
  motion.reference = HeadingReference::kTrue;
  motion.steps = 1;
  motion.step_length_m = 0.7;
  motion.distance_sigma_m = 0.1;
  return motion;
}

/// Numbers bodies from `first` on.
inline SampleBatch numbered(std::uint64_t first, std::vector<SampleBody> bodies) {
  SampleBatch batch;
  for (SampleBody& body : bodies) batch.samples.push_back({first++, std::move(body)});
  return batch;
}

inline Hello track_hello(BuildingId building) {
  Hello hello;
  hello.building = building;
  hello.device_model = "Test Phone";
  hello.app = "test/1";
  hello.phone_time = at(0);
  return hello;
}

}  // namespace wayfuse
