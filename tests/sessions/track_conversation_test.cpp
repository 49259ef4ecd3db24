#include <gtest/gtest.h>

#include "tests/sessions/session_house.hpp"

namespace wayfuse {
namespace {

SampleBody scan(double time_s, BuildingPoint where) {
  return SessionHouse::hall().scan_at(where, at(time_s));
}

TEST(TrackConversation, GreetsAcksAndGivesAPosition) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", true);
  Caller caller;
  house.call(caller);
  caller.say(track_hello(hall));
  const Welcome welcome = caller.output.last<Welcome>();
  EXPECT_EQ(welcome.building, hall);
  EXPECT_EQ(welcome.building_name, "Hall");
  EXPECT_EQ(welcome.pipeline, "nn");
  EXPECT_EQ(welcome.applied_through, 0u);
  EXPECT_FALSE(welcome.recovered);
  EXPECT_EQ(welcome.epoch, 77u);
  EXPECT_NE(welcome.session, welcome.tracked);

  caller.say(numbered(1, {step_at(1.0), scan(1.1, {20, 4})}));
  EXPECT_EQ(caller.output.last<Ack>().through, 2u);
  const Position position = caller.output.last<Position>();
  EXPECT_EQ(position.applied_through, 2u);
  EXPECT_LT(distance_m(position.position.place.point, {20, 4}), 4.0);
  EXPECT_EQ(position.position.valid_at, at(1.1));
  ASSERT_EQ(house.board.sessions(hall).size(), 1u);
  EXPECT_EQ(house.board.sessions(hall)[0].tracked, welcome.tracked);
  EXPECT_TRUE(house.board.sessions(hall)[0].position);
}

TEST(TrackConversation, AsksForHelloFirst) {
  SessionHouse house;
  Caller caller;
  house.call(caller);
  caller.say(SampleBatch{});
  ASSERT_TRUE(caller.output.closed);
  EXPECT_EQ(caller.output.closed->code, FaultCode::kHelloExpected);
}

// As right after a start: "no such building" would send phones and screens away for good.
TEST(TrackConversation, ABuildingWhoseMapIsNotMadeYetIsToBeAskedForAgain) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", true);
  house.buildings.remove(hall);
  Hello watching = track_hello(hall);
  watching.role = Role::kObserve;
  for (const Hello& hello : {track_hello(hall), watching}) {
    Caller early;
    house.call(early);
    early.say(hello);
    ASSERT_TRUE(early.output.closed);
    EXPECT_EQ(early.output.closed->code, FaultCode::kOverloaded);
    EXPECT_EQ(early.output.closed->field, "building");
  }
  house.keeper->refresh(hall);
  Caller later;
  house.call(later);
  later.say(track_hello(hall));
  EXPECT_EQ(later.output.last<Welcome>().building, hall);
}

TEST(TrackConversation, GivesTheSameAnswerForAbsentAndForbiddenBuildings) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", true);
  Rights elsewhere = SessionHouse::everything();
  elsewhere.building = BuildingId{99};
  Caller forbidden;
  house.call(forbidden, elsewhere);
  forbidden.say(track_hello(hall));
  Caller absent;
  house.call(absent);
  absent.say(track_hello(BuildingId{4711}));
  ASSERT_TRUE(forbidden.output.closed && absent.output.closed);
  EXPECT_EQ(*forbidden.output.closed, *absent.output.closed);
  EXPECT_EQ(absent.output.closed->code, FaultCode::kUnknownBuilding);
}

TEST(TrackConversation, LooksTheTokenInTheHelloUp) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", true);
  Hello hello = track_hello(hall);
  Caller wrong;
  house.call(wrong, std::nullopt);
  hello.token = "bad";
  wrong.say(hello);
  ASSERT_TRUE(wrong.output.closed);
  EXPECT_EQ(wrong.output.closed->code, FaultCode::kNotAuthenticated);
  Caller right;
  house.call(right, std::nullopt);
  hello.token = "good";
  right.say(hello);
  EXPECT_FALSE(right.output.closed);
  EXPECT_EQ(right.output.all<Welcome>().size(), 1u);
}

TEST(TrackConversation, RefusesARoleOutsideTheScope) {
  SessionHouse house;
  Rights only_survey = SessionHouse::everything();
  only_survey.track = false;
  Caller caller;
  house.call(caller, only_survey);
  caller.say(track_hello(house.add_building("Hall", true)));
  ASSERT_TRUE(caller.output.closed);
  EXPECT_EQ(caller.output.closed->code, FaultCode::kNotAllowed);
}

TEST(TrackConversation, AcksDuplicatesWithoutEffectAndReportsAGapOnce) {
  SessionHouse house;
  Caller caller;
  house.call(caller);
  caller.say(track_hello(house.add_building("Hall", true)));
  caller.say(numbered(1, {step_at(1), step_at(2)}));
  caller.say(numbered(1, {step_at(1), step_at(2)}));
  EXPECT_EQ(caller.output.last<Ack>().through, 2u);
  EXPECT_EQ(house.counters.samples_applied, 2u);
  EXPECT_EQ(house.counters.samples_duplicate, 2u);

  caller.say(numbered(4, {step_at(4)}));
  caller.say(numbered(5, {step_at(5)}));
  const auto faults = caller.output.all<FaultReport>();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].fault.code, FaultCode::kSequenceGap);
  EXPECT_EQ(faults[0].sequence, 4u);
  EXPECT_EQ(caller.output.last<Ack>().through, 2u);
  caller.say(numbered(3, {step_at(3), step_at(4), step_at(5)}));
  EXPECT_EQ(caller.output.last<Ack>().through, 5u);
  EXPECT_EQ(house.counters.samples_applied, 5u);
}

TEST(TrackConversation, CountsAndReportsWhatComesTooLate) {
  SessionHouse house;
  Caller caller;
  house.call(caller);
  caller.say(track_hello(house.add_building("Hall", true)));
  caller.say(numbered(1, {step_at(10), step_at(7.5), step_at(8.5)}));
  EXPECT_EQ(house.counters.samples_late_dropped, 1u);
  const FaultReport report = caller.output.last<FaultReport>();
  EXPECT_EQ(report.fault.code, FaultCode::kLate);
  EXPECT_EQ(report.sequence, 2u);
  EXPECT_EQ(caller.output.last<Ack>().through, 3u);  // its number is used up: nothing is missing
}

TEST(TrackConversation, SaysWhyThereIsNoPosition) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", true);
  const BuildingId empty = house.add_building("Empty", false);
  Caller lost;
  house.call(lost);
  lost.say(track_hello(hall));
  RssScan strangers{at(1), {{Bssid{0x77}, -50, Duration{0}, 2412, {}, {}}}};
  lost.say(numbered(1, {strangers}));
  EXPECT_EQ(lost.output.last<NoFix>().reason.code, FaultCode::kNoKnownAccessPoint);
  EXPECT_TRUE(lost.output.all<Position>().empty());

  Caller early;
  house.call(early);
  early.say(track_hello(empty));
  early.say(numbered(1, {scan(1, {4, 4})}));
  EXPECT_EQ(early.output.last<NoFix>().reason.code, FaultCode::kEmptyRadioMap);
  // A survey is committed while the phone waits: the session moves to the new map, with what it heard before.
  house.survey(empty);
  house.keeper->refresh(empty);
  early.say(numbered(2, {step_at(1.5)}));
  EXPECT_FALSE(early.output.all<Position>().empty());
  EXPECT_EQ(early.output.last<Welcome>().radio_map_version, early.output.last<Position>().position.radio_map_version);
}

TEST(TrackConversation, APipelineThatMustBeMadeReadyHoldsUpNoConnectionAndLosesNoSample) {
  SessionHouse house, at_once;
  const BuildingId hall = house.add_building("Hall", true), same = at_once.add_building("Hall", true);
  std::vector<std::pair<std::shared_ptr<const Building>, std::string>> wanted;
  house.world->prepare = [&](std::shared_ptr<const Building> building, const std::string& pipeline) {
    if (building->is_first_to_prepare(pipeline)) wanted.emplace_back(std::move(building), pipeline);
  };
  Caller held, quick;
  house.call(held);
  at_once.call(quick);
  Hello hello = track_hello(hall);
  hello.pipeline = "p1";
  held.say(hello);
  hello.building = same;
  quick.say(hello);
  const auto both = [&](std::uint64_t number, std::vector<SampleBody> bodies) {
    held.say(numbered(number, bodies));
    quick.say(numbered(number, std::move(bodies)));
  };
  both(1, {scan(1, {4, 4})});
  both(2, {step_at(1.5)});
  EXPECT_EQ(held.output.last<Ack>().through, 2u);
  EXPECT_EQ(held.output.last<NoFix>().reason.field, "pipeline");
  ASSERT_EQ(wanted.size(), 1u) << "asked for once";
  ASSERT_TRUE(wanted[0].first->pipeline(wanted[0].second));
  both(3, {step_at(2.0)});
  EXPECT_EQ(held.output.last<Position>().position.place, quick.output.last<Position>().position.place);

  Caller foreign;
  house.call(foreign);
  hello.building = hall;
  hello.pipeline = "p99";
  foreign.say(hello);
  ASSERT_TRUE(foreign.output.closed) << "a name that nobody knows is refused at once";
  EXPECT_EQ(foreign.output.closed->code, FaultCode::kUnknownName);
}

TEST(TrackConversation, FindsTheBuildingFromTheFirstScans) {
  SessionHouse house;
  const BuildingId here = house.add_building("Here", true);
  house.add_building("Elsewhere", true, 0x100000);
  Caller caller;
  house.call(caller);
  caller.say(track_hello({}));
  EXPECT_EQ(caller.output.last<Welcome>().building, BuildingId{});
  caller.say(numbered(1, {step_at(0.5)}));
  EXPECT_EQ(caller.output.last<NoFix>().reason.code, FaultCode::kNoBuildingMatches);
  caller.say(numbered(2, {scan(1, {20, 4})}));
  EXPECT_EQ(caller.output.last<Welcome>().building, here);
  EXPECT_EQ(caller.output.last<Position>().position.building, here);
}

TEST(TrackConversation, SilenceAndMissingHelloEndTheConnection) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", true);
  Caller mute;
  house.call(mute);
  Caller idle;
  house.call(idle);
  idle.say(track_hello(hall));
  house.clock.advance(std::chrono::seconds(11));
  mute.conversation->tick();
  idle.conversation->tick();
  ASSERT_TRUE(mute.output.closed);
  EXPECT_EQ(mute.output.closed->code, FaultCode::kTimeout);
  EXPECT_FALSE(idle.output.closed);
  house.clock.advance(std::chrono::minutes(10));
  idle.conversation->receive(Fault{FaultCode::kOutOfRange, "samples[0].time", "bad"});  // not a sign of use
  idle.conversation->tick();
  ASSERT_TRUE(idle.output.closed);
  EXPECT_EQ(idle.output.closed->code, FaultCode::kTimeout);
}

TEST(TrackConversation, AStepOfTheWallClockDisturbsNothing) {
  SessionHouse house;
  Caller caller;
  house.call(caller);
  caller.say(track_hello(house.add_building("Hall", true)));
  house.clock.step_wall(std::chrono::hours(24));
  caller.conversation->tick();
  house.clock.step_wall(std::chrono::hours(-48));
  caller.conversation->tick();
  caller.say(numbered(1, {scan(1, {20, 4})}));
  EXPECT_FALSE(caller.output.closed);
  EXPECT_EQ(caller.output.all<Position>().size(), 1u);
}

TEST(TrackConversation, APhoneAtRestIsToldItsPositionSeldom) {
  SessionHouse house;
  Caller caller;
  house.call(caller);
  caller.say(track_hello(house.add_building("Hall", true)));
  caller.say(numbered(1, {scan(0, {20, 4})}));
  const auto before = caller.output.all<Position>().size();
  for (int i = 1; i <= 40; ++i) {  // 20 s at rest, a report every half second
    MotionReport rest = step_at(0.5 * i);
    rest.steps = 0;
    rest.step_length_m = 0;
    rest.at_rest = true;
    caller.say(numbered(static_cast<std::uint64_t>(i) + 1, {rest}));
  }
  EXPECT_EQ(caller.output.all<Position>().size() - before, 10u);  // one every 2 s
  EXPECT_EQ(caller.output.all<Ack>().size(), 41u);
}

TEST(TrackConversation, OneAbsurdStampDoesNotSilenceTheSessionForGood) {
  SessionHouse house;
  Caller caller;
  house.call(caller);
  caller.say(track_hello(house.add_building("Hall", true)));
  caller.say(numbered(1, {scan(1, {20, 4}), step_at(1e9)}));
  std::uint64_t sequence = 2;
  for (int i = 0; i < 100; ++i) caller.say(numbered(++sequence, {step_at(2 + i), scan(2.1 + i, {20, 4})})), ++sequence;
  EXPECT_NEAR(seconds(caller.output.last<Position>().position.valid_at.time_since_epoch()), 101.1, 1e-6);
}

TEST(TrackConversation, AFreshTokenMustOpenTheSameDoors) {
  SessionHouse house;
  Rights short_lived = SessionHouse::everything();
  short_lived.expires_at = house.clock.wall_now() + std::chrono::minutes(15);
  Caller caller;
  house.call(caller, short_lived);
  caller.say(track_hello(house.add_building("Hall", true)));
  EXPECT_EQ(caller.output.last<Welcome>().token_expires_in, std::chrono::minutes(15));
  caller.say(TokenRefresh{"bad"});
  EXPECT_EQ(caller.output.last<FaultReport>().fault.code, FaultCode::kNotAuthenticated);
  caller.say(TokenRefresh{"good"});
  EXPECT_EQ(caller.output.all<TokenAccepted>().size(), 1u);
  house.clock.advance(std::chrono::minutes(9));
  caller.say(ClockProbe{at(3)});
  EXPECT_EQ(caller.output.last<ClockAnswer>().phone_time, at(3));
  house.clock.advance(std::chrono::minutes(9));
  caller.conversation->tick();
  EXPECT_FALSE(caller.output.closed);
}

}  // namespace
}  // namespace wayfuse
