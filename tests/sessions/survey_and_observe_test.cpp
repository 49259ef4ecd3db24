#include <gtest/gtest.h>

#include "tests/sessions/session_house.hpp"

namespace wayfuse {
namespace {

Hello hello_as(Role role, BuildingId building) {
  Hello hello = track_hello(building);
  hello.role = role;
  return hello;
}

SurveyBatch batch_of(const std::string& key) {
  SurveyBatch batch{key, SessionHouse::hall().survey(1)};
  for (auto& point : batch.points) point.device_model = "plan";
  return batch;
}

TEST(SurveyConversation, AcksAfterTheCommitAndRenewsTheMap) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", false);
  Caller surveyor;
  house.call(surveyor);
  surveyor.say(hello_as(Role::kSurvey, hall));
  EXPECT_EQ(surveyor.output.last<Welcome>().building, hall);
  surveyor.say(batch_of("one"));
  EXPECT_TRUE(surveyor.output.all<SurveyAck>().empty());  // the answer is posted back to the strand
  house.run_posted();
  const SurveyAck ack = surveyor.output.last<SurveyAck>();
  EXPECT_EQ(ack.idempotency_key, "one");
  EXPECT_EQ(ack.stored, 33u);
  EXPECT_EQ(house.buildings.find(hall)->record().survey_version, ack.survey_version);
  EXPECT_EQ(house.buildings.find(hall)->transmitters().size(), 6u);
}

TEST(SurveyConversation, AnswersARetryAgainAndRefusesAnotherBodyUnderTheSameKey) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", false);
  Caller surveyor;
  house.call(surveyor);
  surveyor.say(hello_as(Role::kSurvey, hall));
  surveyor.say(batch_of("one"));
  surveyor.say(batch_of("one"));
  SurveyBatch other = batch_of("one");
  other.points.pop_back();
  surveyor.say(other);
  house.run_posted();
  const auto acks = surveyor.output.all<SurveyAck>();
  ASSERT_EQ(acks.size(), 2u);
  EXPECT_EQ(acks[0], acks[1]);
  const FaultReport report = surveyor.output.last<FaultReport>();
  EXPECT_EQ(report.fault.code, FaultCode::kIdempotencyConflict);
  EXPECT_EQ(report.idempotency_key, "one");
  house.store->with_building(
      hall, [](Result<BuildingDatabase*> database) { EXPECT_EQ(database.value()->count_points().value(), 33u); });
}

TEST(SurveyConversation, HoldsTheSurveyorBackWhenTheStoreIsBehind) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", false);
  Caller surveyor;
  house.call(surveyor);
  surveyor.say(hello_as(Role::kSurvey, hall));
  const auto most = house.world->settings.survey_batches_in_flight;
  for (std::size_t i = 0; i <= most; ++i) surveyor.say(batch_of("b" + std::to_string(i)));
  const FaultReport report = surveyor.output.last<FaultReport>();
  EXPECT_EQ(report.fault.code, FaultCode::kRateLimited);
  EXPECT_EQ(report.idempotency_key, "b" + std::to_string(most));
  EXPECT_GT(report.retry_after, Duration{0});
  house.run_posted();
  EXPECT_EQ(surveyor.output.all<SurveyAck>().size(), most);
}

TEST(SurveyConversation, AnAnswerAfterTheConnectionsEndGoesNowhere) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", false);
  Caller surveyor;
  house.call(surveyor);
  surveyor.say(hello_as(Role::kSurvey, hall));
  surveyor.say(batch_of("one"));
  surveyor.conversation->disconnected();
  surveyor.conversation.reset();
  house.run_posted();
  EXPECT_TRUE(surveyor.output.all<SurveyAck>().empty());
  EXPECT_EQ(house.counters.survey_points, 33u);  // durable all the same
}

// East along the hall's middle row, 1.3 m a second, a scan every 2 s; the phone's compass is a quarter turn off.
SurveyWalk recorded_walk(std::uint32_t part, bool last) {
  SurveyWalk walk;
  walk.idempotency_key = "walk-1-" + std::to_string(part);
  walk.walk = "morning";
  walk.part = part;
  walk.last = last;
  walk.device_model = "Plan";
  const double begin_s = 10.0 * part;
  for (double s = begin_s; s <= begin_s + 10.0; s += 10.0) walk.marks.push_back({at(s + 0.001 * part), {{1.3 * s, 4.0}, FloorOrdinal{0}}, 0.1});
  for (double s = begin_s + 1.0; s <= begin_s + 10.0; s += 1.0) {
    MotionReport step;
    step.time = at(s);
    step.interval = std::chrono::seconds(1);
    step.heading = Heading::from_radians(1.57);
    step.steps = 2;
    step.step_length_m = 0.7;
    walk.motion.push_back(step);
  }
  for (double s = begin_s + 1.0; s < begin_s + 10.0; s += 2.0) walk.scans.push_back(SessionHouse::hall().scan_at({1.3 * s, 4.0}, at(s)));
  return walk;
}

TEST(SurveyConversation, AWalkIsPlacedOnceItsLastPartIsThereAndAsOftenAsItIsSent) {
  SessionHouse house;
  Caller surveyor;
  house.call(surveyor);
  const BuildingId hall = house.add_building("Hall", false);
  surveyor.say(hello_as(Role::kSurvey, hall));
  surveyor.say(recorded_walk(1, true));
  house.run_posted();
  EXPECT_EQ(surveyor.output.last<SurveyAck>().stored, 5u);
  EXPECT_EQ(house.buildings.find(hall)->map_version(), 0u) << "part 0 is missing: nothing is placed yet";
  for (int again = 0; again < 2; ++again) {
    surveyor.say(recorded_walk(0, false));
    house.run_posted();
    ASSERT_EQ(surveyor.output.all<FaultReport>().size(), 0u);
    EXPECT_EQ(surveyor.output.last<SurveyAck>().idempotency_key, "walk-1-0");
    const auto& survey = house.buildings.find(hall)->site()->survey;
    ASSERT_EQ(survey.size(), 10u);
    for (const ReferencePoint& point : survey) {
      const double s = seconds(point.scans.at(0).time.time_since_epoch());
      EXPECT_NEAR(point.place.point.x_m, 1.3 * s, 0.05) << s;
      EXPECT_NEAR(point.place.point.y_m, 4.0, 0.05) << s;
    }
  }
  SurveyWalk other = recorded_walk(0, false);
  other.idempotency_key = "walk-1-0-again";
  surveyor.say(other);
  house.run_posted();
  EXPECT_EQ(surveyor.output.last<FaultReport>().fault.code, FaultCode::kConflict) << "a part is there once";
}

TEST(SurveyConversation, UnknownBuildingAndForeignMessages) {
  SessionHouse house;
  Caller nowhere;
  house.call(nowhere);
  nowhere.say(hello_as(Role::kSurvey, BuildingId{12}));
  ASSERT_TRUE(nowhere.output.closed);
  EXPECT_EQ(nowhere.output.closed->code, FaultCode::kUnknownBuilding);

  Caller surveyor;
  house.call(surveyor);
  surveyor.say(hello_as(Role::kSurvey, house.add_building("Hall", false)));
  surveyor.say(numbered(1, {step_at(1)}));
  EXPECT_EQ(surveyor.output.last<FaultReport>().fault.code, FaultCode::kUnexpectedMessage);
  EXPECT_FALSE(surveyor.output.closed);
}

class Observing : public testing::Test {
 protected:
  Observing() : hall(house.add_building("Hall", true)) {
    house.call(phone);
    phone.say(track_hello(hall));
    house.call(observer);
    observer.say(hello_as(Role::kObserve, hall));
  }
  void walk(int steps) {
    for (int i = 0; i < steps; ++i, ++walked) {
      phone.say(numbered(static_cast<std::uint64_t>(walked) + 1,
                         {SessionHouse::hall().scan_at({4.0 * (walked % 10), 4}, at(walked))}));
    }
  }
  void watch(Subscribe wanted) {
    observer.say(std::move(wanted));
    house.run_posted();
  }
  void next_look() {
    house.clock.advance(std::chrono::seconds(1));
    observer.conversation->tick();
  }
  std::size_t seen() const { return observer.output.all<Observation>().size(); }

  SessionHouse house;
  BuildingId hall;
  Caller phone;
  Caller observer;
  int walked = 0;
};

TEST_F(Observing, SeesTheNewestOfEachAndNoBacklog) {
  walk(5);
  watch(Subscribe{});
  ASSERT_EQ(seen(), 1u);
  ASSERT_EQ(observer.output.last<Observation>().tracked.size(), 1u);
  EXPECT_EQ(observer.output.last<Observation>().tracked[0].tracked, phone.output.last<Welcome>().tracked);
  EXPECT_EQ(observer.output.last<Observation>().tracked[0].position, phone.output.last<Position>().position);
  next_look();
  EXPECT_EQ(seen(), 1u);  // nothing moved
  walk(5);
  next_look();
  EXPECT_EQ(seen(), 2u);  // five moves, one observation
}

TEST_F(Observing, WhoWatchesIsWrittenDownBeforeAnythingIsShown) {
  walk(1);
  observer.say(Subscribe{});
  EXPECT_EQ(seen(), 0u);  // not before the line is durable
  house.run_posted();
  EXPECT_EQ(seen(), 1u);
  const auto lines = house.store->audited({});
  ASSERT_TRUE(lines);
  ASSERT_EQ(lines->size(), 1u);
  EXPECT_EQ(lines->at(0).action, "observe");
  EXPECT_EQ(lines->at(0).key_id, SessionHouse::everything().key_id);
  EXPECT_EQ(lines->at(0).building, hall);
}

TEST_F(Observing, ASlowObserverMissesOnlyWhatIsOutdated) {
  watch(Subscribe{});
  observer.output.is_congested = true;
  walk(5);
  next_look();
  EXPECT_EQ(seen(), 0u);
  walk(5);
  observer.output.is_congested = false;
  next_look();
  ASSERT_EQ(seen(), 1u);
  EXPECT_EQ(observer.output.last<Observation>().tracked[0].position, phone.output.last<Position>().position);
}

TEST_F(Observing, IsToldWhenAPhoneIsGone) {
  walk(1);
  watch(Subscribe{});
  phone.say(Goodbye{});
  next_look();
  EXPECT_TRUE(observer.output.last<Observation>().tracked[0].gone);
  EXPECT_TRUE(house.board.sessions(hall).empty());
  house.board.sweep(house.clock.wall_now() + std::chrono::minutes(1));
  EXPECT_EQ(house.board.size(), 0u);
}

TEST_F(Observing, SeesOnlyTheFloorsAndPhonesAskedFor) {
  walk(1);
  Subscribe upstairs;
  upstairs.floors = {FloorOrdinal{1}};
  watch(upstairs);
  EXPECT_EQ(seen(), 0u);
  Subscribe another;
  another.tracked = {"somebody-else"};
  watch(another);
  EXPECT_EQ(seen(), 0u);
  Subscribe this_one;
  this_one.tracked = {phone.output.last<Welcome>().tracked};
  watch(this_one);
  EXPECT_EQ(seen(), 1u);
}

TEST_F(Observing, DoesNotSeeOtherBuildings) {
  walk(1);
  const BuildingId other = house.add_building("Other", true, 0x100000);
  Caller elsewhere;
  house.call(elsewhere);
  elsewhere.say(hello_as(Role::kObserve, other));
  elsewhere.say(Subscribe{});
  house.run_posted();
  EXPECT_TRUE(elsewhere.output.all<Observation>().empty());
}

TEST_F(Observing, LargeViewsAreSplit) {
  for (int i = 0; i < 150; ++i) {
    SessionSummary summary;
    summary.tracked = "walker-" + std::to_string(i);
    summary.building = hall;
    house.board.put(summary);
    FusedPosition position;
    position.building = hall;
    house.board.moved(summary.tracked, position, 1, house.clock.wall_now());
  }
  watch(Subscribe{});
  EXPECT_EQ(seen(), 3u);
  EXPECT_EQ(observer.output.last<Observation>().tracked.size(), 150u - 2 * Limits::kObservedPerMessage);
}

TEST_F(Observing, SilenceDoesNotEndAnObserver) {
  watch(Subscribe{});
  house.clock.advance(std::chrono::hours(1));
  observer.conversation->tick();
  EXPECT_FALSE(observer.output.closed);
  EXPECT_LT(observer.conversation->tick_interval(), std::chrono::seconds(1));
}

}  // namespace
}  // namespace wayfuse
