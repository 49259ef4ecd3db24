#include "tests/sdk_client/scripted_link.hpp"

namespace wayfuse {
namespace {

using enum ClientState;
using namespace std::chrono_literals;

class HostileServer : public ClientTest {
 protected:
  void expect_left(FaultCode code) {
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_EQ(faults[0].fault.code, code);
    EXPECT_TRUE(ends[0]->closed);
    EXPECT_EQ(client->state(), kBackingOff);
    EXPECT_EQ(client->acked_through(), 0u);
    ASSERT_TRUE(wait_for_attempt());  // and all samples go to whoever answers honestly
    far().open();
    EXPECT_FALSE(far().all<Hello>().at(0).resume);
    far().say(fresh("s9"));
    run(1);
    EXPECT_EQ(far().sequences(), numbers(1, 5));
  }
};

TEST_F(HostileServer, CannotAcknowledgeWhatWasNeverSent) {
  start_streaming();
  walk(4);
  run(1);
  walk(1);
  far().say(Ack{7, 5});
  expect_left(FaultCode::kOutOfRange);
}

TEST_F(HostileServer, CannotApplyMoreThanItWasSent) {
  start_streaming();
  walk(4);
  run(1);
  far().drop();
  ASSERT_TRUE(wait_for_attempt());
  ends.erase(ends.begin());
  walk(1);
  far().open();
  far().say(recovered(5));
  expect_left(FaultCode::kOutOfRange);
}

TEST_F(HostileServer, CannotBeginANewSessionInTheMiddle) {
  make();
  walk(5);
  client->start();
  far().open();
  Welcome odd = fresh();
  odd.applied_through = 3;
  far().say(odd);
  expect_left(FaultCode::kOutOfRange);
}

TEST_F(HostileServer, CannotRecoverAnotherSession) {
  start_streaming();
  walk(5);
  run(1);
  far().drop();
  ASSERT_TRUE(wait_for_attempt());
  ends.erase(ends.begin());
  far().open();
  far().say(recovered(2, "another"));
  expect_left(FaultCode::kUnexpectedMessage);
}

TEST_F(HostileServer, GarbageEndsTheConnectionNotTheClient) {
  const std::string good = encode(ServerMessage(fresh()), Encoding::kCbor);
  std::vector<std::string> frames = {
      "", "{}", std::string("\0", 1), std::string(70'000, 'x'), good.substr(0, good.size() - 1), good + "x"};
  for (std::size_t length = 1; length < good.size(); length += 3) frames.push_back(good.substr(0, length));
  for (const std::string& frame : frames) {
    faults.clear();
    make();
    client->start();
    far().open();
    far().events.received(frame);
    EXPECT_EQ(client->state(), kBackingOff) << frame.size();
    EXPECT_EQ(faults.size(), 1u);
  }
}

TEST_F(HostileServer, EveryFlippedBitLeavesAClientThatGoesOn) {
  const std::string good = encode(ServerMessage(fresh()), Encoding::kCbor);
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    make();
    client->start();
    far().open();
    far().events.received(bad);
    EXPECT_NE(client->state(), kEnded);
    client->network_changed();
    far().open();
    EXPECT_EQ(client->state(), kGreeting);
  }
}

TEST_F(HostileServer, WhatANewerServerSaysIsPassedOver) {
  start_streaming();
  far().encoding = Encoding::kCbor;
  make();
  client->start();
  far().encoding = Encoding::kJson;
  far().open();
  far().say(fresh());
  far().events.received(R"({"type":"horoscope","sign":"lion"})");
  EXPECT_EQ(client->state(), kStreaming);
  EXPECT_TRUE(faults.empty());
}

TEST_F(HostileServer, AcksOfAnotherEpochMeanNothing) {
  start_streaming();
  walk(5);
  run(1);
  far().say(Ack{6, 5});
  EXPECT_EQ(client->acked_through(), 0u);
  EXPECT_EQ(client->state(), kStreaming);
}

TEST_F(HostileServer, AcksThatGoBackMeanNothing) {
  start_streaming();
  walk(5);
  run(1);
  far().say(Ack{7, 5});
  far().say(Ack{7, 2});
  EXPECT_EQ(client->acked_through(), 5u);
}

TEST_F(HostileServer, CannotMakeTheClientWaitForEver) {
  settings.sample_ring = 10min;
  start_streaming();
  walk(1);
  far().say(FaultReport{{FaultCode::kRateLimited, "", ""}, 0, {}, std::chrono::hours(24)});
  for (int i = 0; i < 11; ++i) {
    run(30);
    far().events.alive();
  }
  EXPECT_EQ(far().sequences(), numbers(1, 1));
  far().say(GoAway{std::chrono::hours(24), ""});
  for (int i = 0; i < 25 && ends.size() == 1; ++i) {
    run(25);
    far().events.alive();
  }
  EXPECT_EQ(ends.size(), 2u);
}

TEST_F(HostileServer, CannotMakeTheClientHurry) {
  // Welcome and hang up, again and again: the ceiling still grows, so that attempts thin out.
  make();
  client->start();
  const PhoneTime begun = clock.now();
  for (int i = 0; i < 20; ++i) {
    far().open();
    far().say(fresh());
    far().drop();
    ASSERT_TRUE(wait_for_attempt());
  }
  EXPECT_GT(clock.now() - begun, 60s);
}

TEST_F(HostileServer, MessagesBeforeWelcomeAreNotBelieved) {
  make(Role::kSurvey);
  client->start();
  far().open();
  far().say(SurveyAck{"k", 1, 1});
  far().say(Ack{0, 0});
  EXPECT_TRUE(stored.empty());
  EXPECT_EQ(client->state(), kGreeting);
}

}  // namespace
}  // namespace wayfuse
