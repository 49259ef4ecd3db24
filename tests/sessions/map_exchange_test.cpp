#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sessions/session_house.hpp"

// A session goes over to the newer map of its building, and stays one walk.
namespace wayfuse {
namespace {

struct HalfSurveyedHall {
  HalfSurveyedHall() : hall(house.add_building("Hall", false)) { survey(0.0, 20.0); }

  /// The hall's points with x in [from, to).
  void survey(double from_m, double to_m) {
    SurveyBatch batch{"part-" + std::to_string(from_m), SessionHouse::hall().survey(1)};
    std::erase_if(batch.points, [&](const auto& point) { return point.place.point.x_m < from_m || point.place.point.x_m >= to_m; });
    for (auto& point : batch.points) point.device_model = "plan";
    house.store->store(hall, batch, [](Result<SurveyAck> ack) { ASSERT_TRUE(ack) << to_string(ack.fault()); });
    house.keeper->refresh(hall);
  }
  void roll_back() {
    house.store->with_building(hall, [](Result<BuildingDatabase*> database) { ASSERT_TRUE((*database)->roll_back({})); });
    house.keeper->refresh(hall);
  }
  void set_pipeline(const std::string& name) {
    house.store->with_building(hall, [&](Result<BuildingDatabase*> database) {
      BuildingRecord record = *(*database)->building();
      record.pipeline = name;
      ASSERT_TRUE((*database)->update(record));
    });
    house.keeper->refresh(hall);
  }
  void begin(Caller& caller, const std::string& pipeline) {
    house.call(caller);
    Hello hello = track_hello(hall);
    hello.pipeline = pipeline;
    caller.say(hello);
  }
  /// Seconds `from` + 1 .. `to` of a walk eastwards from x = 2, 1.2 m/s; two samples a second, one batch each.
  static void walk(Caller& caller, int from, int to) {
    for (int i = from + 1; i <= to; ++i) {
      MotionReport motion = step_at(i);
      motion.interval = from_seconds(1.0);
      motion.steps = 2;
      motion.step_length_m = 0.6;
      const RssScan scan = SessionHouse::hall().scan_at({2.0 + 1.2 * i, 4.0}, at(i));
      caller.say(numbered(static_cast<std::uint64_t>(2 * i - 1), {motion, scan}));
    }
  }
  std::uint64_t live() const { return house.buildings.find(hall)->map_version(); }

  SessionHouse house;
  BuildingId hall;
};

class MapExchange : public testing::Test, protected HalfSurveyedHall {};
class MapExchangeOf : public MapExchange, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Pipelines, MapExchangeOf, testing::Values("default", "p1", "p3", "p4", "wknn"),
                         [](const auto& made) { return std::string(made.param); });

TEST_P(MapExchangeOf, AWalkThatBeganOnHalfTheSurveyEndsOnTheWholeOfIt) {
  Caller caller;
  begin(caller, GetParam());
  walk(caller, 0, 14);
  const auto half = live();
  EXPECT_EQ(caller.output.last<Position>().position.radio_map_version, half);
  EXPECT_EQ(caller.output.last<Welcome>().radio_map_version, half);
  survey(20.0, 100.0);
  ASSERT_GT(live(), half);
  walk(caller, 14, 15);
  EXPECT_EQ(caller.output.last<Welcome>().radio_map_version, live()) << "the phone is told";
  walk(caller, 15, 30);
  const auto positions = caller.output.all<Position>();
  ASSERT_EQ(positions.size(), 30u);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    EXPECT_EQ(positions[i].position.radio_map_version, i < 14 ? half : live()) << "second " << i + 1;
  }
  EXPECT_LT(distance_m(positions.back().position.place.point, {38, 4}), 8.0);
  EXPECT_EQ(caller.output.last<Welcome>().session, caller.output.all<Welcome>().front().session) << "one session all along";
}

TEST_P(MapExchangeOf, ARollbackTakesTheSessionBack) {
  Caller caller;
  begin(caller, GetParam());
  const auto half = live();
  survey(20.0, 100.0);
  walk(caller, 0, 10);
  EXPECT_GT(caller.output.last<Position>().position.radio_map_version, half);
  roll_back();
  ASSERT_EQ(live(), half);
  walk(caller, 10, 11);
  EXPECT_EQ(caller.output.last<Position>().position.radio_map_version, half);
}

TEST_P(MapExchangeOf, AStragglerOlderThanTheExchangeChangesNoBit) {
  std::vector<SampleBody> bodies;
  for (int i = 1; i <= 20; ++i) {
    bodies.push_back(step_at(0.5 * i));
    bodies.push_back(SessionHouse::hall().scan_at({2.0 + 0.7 * i, 4.0}, at(0.5 * i)));
  }
  std::vector<FusedPosition> ends;
  for (const bool late : {false, true}) {
    HalfSurveyedHall world;
    Caller caller;
    world.begin(caller, GetParam());
    auto sent = bodies;
    if (late) std::rotate(sent.begin() + 15, sent.begin() + 16, sent.begin() + 23);  // heard before the exchange, arrives after it
    for (std::size_t i = 0; i < sent.size(); ++i) {
      if (i == 20 - (late ? 1 : 0)) world.survey(20.0, 100.0);  // what is newest by then is the same
      caller.say(numbered(i + 1, {sent[i]}));
    }
    ends.push_back(caller.output.last<Position>().position);
    EXPECT_EQ(ends.back().radio_map_version, world.live());
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST_F(MapExchange, ARetiredMapIsGoneOnceNoSessionCanNeedIt) {
  Caller caller;
  begin(caller, "default");
  walk(caller, 0, 5);
  const std::weak_ptr<const Building> retired = house.buildings.find(hall);
  const std::weak_ptr<const Site> site = retired.lock()->site();
  survey(20.0, 100.0);
  EXPECT_FALSE(site.expired()) << "the phone has not spoken since";
  walk(caller, 5, 6);
  EXPECT_TRUE(retired.expired());
  EXPECT_FALSE(site.expired()) << "a straggler could still be older than the exchange";
  walk(caller, 6, 14);
  EXPECT_TRUE(site.expired());
}

TEST_F(MapExchange, ANewPipelineOfTheBuildingTakesOverWhereTheOldOneStood) {
  set_pipeline("p1");
  Caller own, chosen;
  begin(own, "");
  begin(chosen, "wknn");
  walk(own, 0, 10);
  walk(chosen, 0, 10);
  const auto before = own.output.last<Position>().position;
  set_pipeline("default");
  walk(own, 10, 11);
  walk(chosen, 10, 11);
  EXPECT_EQ(own.output.last<Welcome>().pipeline, "default");
  EXPECT_EQ(house.board.sessions(hall).size(), 2u);
  const auto after = own.output.last<Position>().position;
  EXPECT_LT(distance_m(before.place.point, after.place.point), 1.2 + 2.0 * before.radius68_m);
  EXPECT_EQ(chosen.output.last<Welcome>().pipeline, "wknn") << "asked for by the phone, and kept";
}

TEST_F(MapExchange, WhatSessionsTrackWithIsReadyBeforeTheyMove) {
  Caller caller;
  begin(caller, "wknn");
  walk(caller, 0, 2);
  survey(20.0, 100.0);
  EXPECT_EQ(house.buildings.find(hall)->prepared(), (std::vector<std::string>{"nn", "wknn"})) << "its own and the one in use";
  walk(caller, 2, 14);
  caller.say(Goodbye{"done"});
  caller.conversation.reset();
  survey(100.0, 200.0);
  house.keeper->refresh(hall);
  house.keeper->refresh(hall);
  EXPECT_EQ(house.buildings.find(hall)->prepared(), std::vector<std::string>{"nn"}) << "nobody needs it any more";
}

TEST_F(MapExchange, AResumedSessionFollowsToo) {
  auto caller = std::make_unique<Caller>();
  begin(*caller, "default");
  walk(*caller, 0, 10);
  const Welcome welcome = caller->output.last<Welcome>();
  caller->conversation->disconnected();
  survey(20.0, 100.0);
  caller = std::make_unique<Caller>();
  house.call(*caller);
  Hello hello = track_hello(hall);
  hello.pipeline = "default";
  hello.resume = Resume{welcome.session, welcome.epoch, 20, ""};
  caller->say(hello);
  EXPECT_TRUE(caller->output.last<Welcome>().recovered);
  walk(*caller, 10, 12);
  EXPECT_EQ(caller->output.last<Position>().position.radio_map_version, live());
}

}  // namespace
}  // namespace wayfuse
