#pragma once

#include "server/recordings/recording_desk.hpp"
#include "tests/sessions/session_house.hpp"

namespace wayfuse {

/// A hall whose sessions can be recorded; store and workers run inline.
class RecordedHouse {
 public:
  explicit RecordedHouse(std::uint64_t seed = 1) : house(seed), recordings(house.clock, house.sessions.epoch()) {
    house.world->recordings = &recordings;
    desk = std::make_unique<RecordingDesk>(recordings, *house.store, house.buildings, [](std::function<void()> task) { task(); });
    hall = house.add_building("Hall", false);
  }

  void record(RecordingOrder order = {.on_for = std::chrono::hours(1), .tracked = {}}) { ASSERT_TRUE(desk->order(hall, order)); }
  /// The hall's points with x in [from, to), as a newer map.
  void survey(double from_m, double to_m, const std::string& name) {
    SurveyBatch batch{name, SessionHouse::hall().survey(1)};
    std::erase_if(batch.points, [&](const auto& point) { return point.place.point.x_m < from_m || point.place.point.x_m >= to_m; });
    for (auto& point : batch.points) point.device_model = "plan", point.walk = name + std::to_string(static_cast<int>(point.place.point.y_m));
    house.store->store(hall, batch, [](Result<SurveyAck> ack) { ASSERT_TRUE(ack) << to_string(ack.fault()); });
    house.keeper->refresh(hall);
  }
  void with_database(const std::function<void(BuildingDatabase&)>& task) {
    house.store->with_building(hall, [&](Result<BuildingDatabase*> database) { task(*database.value()); });
    house.keeper->refresh(hall);
  }
  void set_pipeline(const std::string& name) {
    with_database([&](BuildingDatabase& database) {
      BuildingRecord record = *database.building();
      record.pipeline = name;
      ASSERT_TRUE(database.update(record));
    });
  }
  std::vector<RecordingSummary> list() const { return *desk->recordings(hall, 0, 1000); }
  Result<ReplayAnswer> replay(std::uint64_t id, ReplayQuestion question = {}) {
    Result<ReplayAnswer> answer = Fault{};
    desk->replay(id, hall, question, [&](Result<ReplayAnswer> got) { answer = std::move(got); });
    return answer;
  }
  /// Every step, page by page.
  ReplayAnswer replay_all(std::uint64_t id, ReplayQuestion question = {}) {
    question.most = 200;
    question.particles = 0;
    auto answer = replay(id, question);
    EXPECT_TRUE(answer) << to_string(answer.fault());
    if (!answer) return {};
    while (answer->page.size() < answer->steps) {
      question.after = answer->page.back().number;
      auto more = replay(id, question);
      EXPECT_TRUE(more && !more->page.empty());
      if (!more || more->page.empty()) break;
      for (ReplayStep& step : more->page) answer->page.push_back(std::move(step));
    }
    return *std::move(answer);
  }

  SessionHouse house;
  RecordingShelf recordings;
  std::unique_ptr<RecordingDesk> desk;
  BuildingId hall;
};

/// One phone that walks through the hall, breaks off and resumes.
struct WalkingPhone {
  WalkingPhone(RecordedHouse& in, std::string by) : world(in), pipeline(std::move(by)) { connect(); }

  void connect() {
    if (caller) caller->conversation->disconnected();
    caller = std::make_unique<Caller>();
    world.house.call(*caller);
    Hello hello = track_hello(world.hall);
    hello.pipeline = pipeline;
    if (welcome) hello.resume = Resume{welcome->session, welcome->epoch, sent, ""};
    caller->say(hello);
    welcome = caller->output.last<Welcome>();
  }
  void send(std::vector<SampleBody> bodies) {
    const std::size_t count = bodies.size();
    caller->output.said.clear();
    caller->say(numbered(sent + 1, std::move(bodies)));
    sent += count;
    for (const Position& position : caller->output.all<Position>()) told.push_back(position.position);
  }
  /// A second of walking: a report and, every other second, a scan.
  std::vector<SampleBody> second() {
    ++now_s;
    MotionReport motion = step_at(now_s, 0.1);
    motion.interval = from_seconds(1.0);
    motion.steps = 2;
    motion.step_length_m = 0.6;
    std::vector<SampleBody> bodies{motion};
    if (now_s % 2 == 0) bodies.push_back(SessionHouse::hall().scan_at({2.0 + 36.0 * std::abs(std::sin(now_s / 40.0)), 4.0}, at(now_s)));
    return bodies;
  }
  void walk(int seconds) {
    for (int i = 0; i < seconds; ++i) send(second());
  }

  RecordedHouse& world;
  const std::string pipeline;
  std::unique_ptr<Caller> caller;
  std::optional<Welcome> welcome;
  std::uint64_t sent = 0;
  int now_s = 0;
  std::vector<FusedPosition> told;
};

}  // namespace wayfuse
