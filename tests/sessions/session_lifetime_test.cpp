#include <gtest/gtest.h>

#include "tests/sessions/session_house.hpp"

namespace wayfuse {
namespace {

SampleBody scan(double time_s, BuildingPoint where) {
  return SessionHouse::hall().scan_at(where, at(time_s));
}

TEST(SessionLifetime, AResumedSessionGoesOnBitForBit) {
  const auto walk = [](int i) -> std::vector<SampleBody> {
    return {step_at(i), scan(i + 0.2, {2.0 + 0.7 * i, 4.0}), step_at(i + 0.5, 0.1 * i)};
  };
  std::vector<Position> whole;
  std::vector<Position> broken;
  for (const bool breaks : {false, true}) {
    SessionHouse house(9);
    const BuildingId hall = house.add_building("Hall", true);
    std::vector<Position>& positions = breaks ? broken : whole;
    auto caller = std::make_unique<Caller>();
    house.call(*caller);
    Hello hello = track_hello(hall);
    hello.pipeline = "p1";
    caller->say(hello);
    const Welcome welcome = caller->output.last<Welcome>();
    for (int i = 0; i < 30; ++i) {
      if (breaks && i % 7 == 6) {
        caller->conversation->disconnected();
        caller = std::make_unique<Caller>();
        house.call(*caller);
        hello.resume = Resume{welcome.session, welcome.epoch, static_cast<std::uint64_t>(3 * i - 2), ""};
        caller->say(hello);
        const Welcome again = caller->output.last<Welcome>();
        ASSERT_TRUE(again.recovered);
        ASSERT_EQ(again.applied_through, static_cast<std::uint64_t>(3 * i));
        caller->say(numbered(static_cast<std::uint64_t>(3 * i - 1), {step_at(0), step_at(0)}));  // replayed: without effect
      }
      caller->output.said.clear();
      caller->say(numbered(static_cast<std::uint64_t>(3 * i + 1), walk(i)));
      positions.push_back(caller->output.last<Position>());
    }
  }
  EXPECT_EQ(whole, broken);
}

TEST(SessionLifetime, ALostSessionBeginsAnewWhereTheClientsSamplesBegin) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", true);
  Hello hello = track_hello(hall);
  hello.resume = Resume{"gone", 76, 41, ""};
  Caller caller;
  house.call(caller);
  caller.say(hello);
  EXPECT_FALSE(caller.output.last<Welcome>().recovered);
  EXPECT_EQ(caller.output.last<Welcome>().applied_through, 41u);
  caller.say(numbered(42, {scan(1, {4, 4})}));
  EXPECT_EQ(caller.output.last<Ack>().through, 42u);
}

TEST(SessionLifetime, AnotherKeyCannotResumeTheSession) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", true);
  Caller owner;
  house.call(owner);
  owner.say(track_hello(hall));
  const Welcome welcome = owner.output.last<Welcome>();
  Rights thief = SessionHouse::everything();
  thief.key_id = 6;
  Hello hello = track_hello(hall);
  hello.resume = Resume{welcome.session, welcome.epoch, 0, ""};
  Caller caller;
  house.call(caller, thief);
  caller.say(hello);
  EXPECT_FALSE(caller.output.last<Welcome>().recovered);
  EXPECT_NE(caller.output.last<Welcome>().session, welcome.session);
}

TEST(SessionLifetime, TheNewestConnectionOwnsTheSession) {
  SessionHouse house;
  const BuildingId hall = house.add_building("Hall", true);
  Caller half_open;
  house.call(half_open);
  half_open.say(track_hello(hall));
  half_open.say(numbered(1, {step_at(1)}));
  const Welcome welcome = half_open.output.last<Welcome>();
  Hello hello = track_hello(hall);
  hello.resume = Resume{welcome.session, welcome.epoch, 1, ""};
  Caller newer;
  house.call(newer);
  newer.say(hello);
  EXPECT_TRUE(newer.output.last<Welcome>().recovered);
  half_open.say(numbered(2, {step_at(2)}));
  ASSERT_TRUE(half_open.output.closed);
  EXPECT_EQ(half_open.output.closed->code, FaultCode::kConflict);
  half_open.conversation->disconnected();
  newer.say(numbered(2, {step_at(2)}));
  EXPECT_EQ(newer.output.last<Ack>().through, 2u);
  EXPECT_TRUE(house.board.sessions(hall)[0].connected);
}

TEST(SessionLifetime, ASessionExpiresWithoutItsConnectionAndAtGoodbye) {
  SessionHouse house(1, {.resumable = std::chrono::minutes(5), .most = 10});
  const BuildingId hall = house.add_building("Hall", true);
  Caller caller;
  house.call(caller);
  caller.say(track_hello(hall));
  caller.conversation->disconnected();
  house.clock.advance(std::chrono::minutes(5));
  EXPECT_TRUE(house.sessions.sweep(house.clock.now()).empty());
  house.clock.advance(std::chrono::seconds(1));
  EXPECT_EQ(house.sessions.sweep(house.clock.now()).size(), 1u);
  EXPECT_EQ(house.sessions.size(), 0u);

  Caller polite;
  house.call(polite);
  polite.say(track_hello(hall));
  polite.say(Goodbye{"done"});
  EXPECT_TRUE(polite.output.finished);
  EXPECT_EQ(house.sessions.size(), 0u);
}

TEST(SessionLifetime, ShelvesAreBounded) {
  SessionHouse house(1, {.resumable = std::chrono::minutes(5), .most = 2});
  const BuildingId hall = house.add_building("Hall", true);
  Caller first;
  Caller second;
  Caller third;
  Caller fourth;
  for (Caller* caller : {&first, &second, &third, &fourth}) house.call(*caller);
  first.say(track_hello(hall));
  second.say(track_hello(hall));
  third.say(track_hello(hall));
  ASSERT_TRUE(third.output.closed);
  EXPECT_EQ(third.output.closed->code, FaultCode::kOverloaded);
  first.conversation->disconnected();
  fourth.say(track_hello(hall));  // the one that left makes room
  EXPECT_FALSE(fourth.output.closed);
}

}  // namespace
}  // namespace wayfuse
