#include "tests/sdk_client/scripted_link.hpp"

namespace wayfuse {
namespace {

using enum ClientState;
using testing::Test;
using namespace std::chrono_literals;

class ClientConnection : public ClientTest {};

TEST_F(ClientConnection, WalksThroughItsStatesInOrder) {
  make();
  EXPECT_EQ(client->state(), kIdle);
  client->start();
  EXPECT_EQ(client->state(), kConnecting);
  far().open();
  EXPECT_EQ(client->state(), kGreeting);
  far().say(fresh());
  EXPECT_EQ(client->state(), kStreaming);
  far().drop();
  EXPECT_EQ(client->state(), kBackingOff);
  ASSERT_TRUE(wait_for_attempt());
  EXPECT_EQ(client->state(), kConnecting);
  client->stop();
  EXPECT_EQ(client->state(), kEnded);
  EXPECT_EQ(states, (std::vector{kConnecting, kGreeting, kStreaming, kBackingOff, kConnecting, kEnded}));
}

TEST_F(ClientConnection, SaysHelloWithWhatItWasGiven) {
  settings.building = BuildingId{3};
  settings.device_model = "Pixel 7";
  settings.app = "demo/1";
  settings.pipeline = "p1";
  make();
  client->start();
  far().open();
  const auto hellos = far().all<Hello>();
  ASSERT_EQ(hellos.size(), 1u);
  const Hello expected{Role::kTrack, BuildingId{3}, "key", "Pixel 7", "demo/1", "p1", clock.now(), std::nullopt};
  EXPECT_EQ(hellos[0], expected);
}

TEST_F(ClientConnection, SpeaksTheEncodingTheLinkNegotiated) {
  make();
  client->start();
  far().encoding = Encoding::kJson;
  far().open();
  far().say(fresh());
  EXPECT_EQ(client->state(), kStreaming);
}

TEST_F(ClientConnection, BacksOffWithFullJitterUpToTheCeiling) {
  // Attempt n waits uniformly in 0 .. min(30 s, 0.5 s * 2^n). Over many seeds the waits fill that interval and never leave it.
  for (int attempt : {0, 1, 3, 6, 9}) {
    const double ceiling = std::min(30.0, 0.5 * std::ldexp(1.0, attempt));
    double least = 1e9;
    double most = 0;
    for (seed = 1; seed <= 60; ++seed) {
      ends.clear();
      connected_at.clear();
      make();
      client->start();
      for (int i = 0; i <= attempt; ++i) {
        far().drop();
        ASSERT_TRUE(wait_for_attempt(31s));
      }
      const double waited = seconds(connected_at.back() - connected_at[connected_at.size() - 2]);
      least = std::min(least, waited);
      most = std::max(most, waited);
      client.reset();
    }
    EXPECT_LE(most, ceiling + 0.001) << attempt;
    EXPECT_GT(most, 0.8 * ceiling) << attempt;  // (1 - 0.8^60) of all seed sets pass; these seeds do
    EXPECT_LT(least, 0.2 * ceiling) << attempt;
  }
}

TEST_F(ClientConnection, ForgetsItsPatienceAfterASteadyConnection) {
  start_streaming();
  for (int i = 0; i < 8; ++i) {  // short-lived connections: the ceiling grows
    far().drop();
    ASSERT_TRUE(wait_for_attempt(61s));
    far().open();
    far().say(recovered(0));
  }
  run(5);
  const PhoneTime lost_at = clock.now();
  far().drop();
  ASSERT_TRUE(wait_for_attempt());
  EXPECT_LE(connected_at.back() - lost_at, 500ms);
}

TEST_F(ClientConnection, ALinkThatNeverOpensIsGivenUp) {
  make();
  client->start();
  run(29.9);
  EXPECT_EQ(client->state(), kConnecting);
  run(0.2);
  EXPECT_EQ(client->state() == kConnecting && ends.size() == 1, false);
  EXPECT_TRUE(ends[0]->closed);
}

TEST_F(ClientConnection, AServerThatNeverWelcomesIsGivenUp) {
  make();
  client->start();
  far().open();
  run(10.1);
  EXPECT_TRUE(ends[0]->closed);
  EXPECT_EQ(reasons.at(0), "the server did not answer hello");
}

TEST_F(ClientConnection, AsksAfterHalfItsPatienceAndLeavesASilentServer) {
  start_streaming();
  run(29.9);
  EXPECT_TRUE(far().all<ClockProbe>().empty());
  run(0.2);
  EXPECT_EQ(far().all<ClockProbe>().size(), 1u);
  run(29.8);
  EXPECT_EQ(client->state(), kStreaming);
  run(0.2);
  EXPECT_TRUE(ends[0]->closed);
  EXPECT_EQ(reasons.at(0), "the server fell silent");
}

TEST_F(ClientConnection, AnySignOfLifeKeepsTheLink) {
  start_streaming();
  for (int i = 0; i < 30; ++i) {
    run(25);
    far().events.alive();
  }
  EXPECT_EQ(client->state(), kStreaming);
  EXPECT_EQ(ends.size(), 1u);
}

TEST_F(ClientConnection, AsksForAFreshTokenBeforeEveryConnection) {
  start_streaming();
  token = "fresh";
  far().drop();
  ASSERT_TRUE(wait_for_attempt());
  far().open();
  EXPECT_EQ(far().all<Hello>().at(0).token, "fresh");
}

TEST_F(ClientConnection, RenewsTheTokenBeforeItExpires) {
  make();
  client->start();
  far().open();
  Welcome welcome = fresh();
  welcome.token_expires_in = 40s;
  far().say(welcome);
  token = "renewed";
  run(35.9);
  EXPECT_TRUE(far().all<TokenRefresh>().empty());
  run(0.2);  // 9/10 of 40 s
  ASSERT_EQ(far().all<TokenRefresh>().size(), 1u);
  EXPECT_EQ(far().all<TokenRefresh>()[0].token, "renewed");
  far().say(TokenAccepted{20s});
  run(18.1);
  EXPECT_EQ(far().all<TokenRefresh>().size(), 2u);
}

TEST_F(ClientConnection, EndsWhenItsTokensAreRefusedAgainAndAgain) {
  make();
  client->start();
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(ends.size(), static_cast<std::size_t>(i + 1));
    far().open();
    far().say(FaultReport{{FaultCode::kNotAuthenticated, "token", "not valid"}, 0, {}, 0s});
    if (i < 2) {
      ASSERT_TRUE(wait_for_attempt());
    }
  }
  EXPECT_EQ(client->state(), kEnded);
  EXPECT_EQ(tokens_asked, 3);
  EXPECT_EQ(faults.size(), 3u);
  client->start();  // the application may have a better one now
  EXPECT_EQ(client->state(), kConnecting);
}

TEST_F(ClientConnection, EndsWhereAskingAgainIsPointless) {
  for (const FaultCode code : {FaultCode::kUnknownBuilding, FaultCode::kNotAllowed, FaultCode::kUnknownName}) {
    make();
    client->start();
    far().open();
    far().say(FaultReport{{code, "building", "none such"}, 0, {}, 0s});
    EXPECT_EQ(client->state(), kEnded);
    EXPECT_TRUE(far().closed);
  }
}

TEST_F(ClientConnection, LeavesADrainingServerAtRandomWithinTheTimeGiven) {
  double least = 1e9;
  double most = 0;
  for (seed = 1; seed <= 60; ++seed) {
    ends.clear();
    connected_at.clear();
    start_streaming();
    const PhoneTime told = clock.now();
    far().say(GoAway{8s, "restart"});
    EXPECT_EQ(client->state(), kStreaming);
    ASSERT_TRUE(wait_for_attempt(9s));
    EXPECT_TRUE(ends[0]->closed);
    least = std::min(least, seconds(connected_at.back() - told));
    most = std::max(most, seconds(connected_at.back() - told));
    client.reset();
  }
  EXPECT_LE(most, 8.001);
  EXPECT_GT(most, 6.4);
  EXPECT_LT(least, 1.6);
}

TEST_F(ClientConnection, KeepsItsChosenMomentWhenTheDrainingServerClosesFirst) {
  start_streaming();
  const PhoneTime told = clock.now();
  far().say(GoAway{8s, "restart"});
  far().drop();
  ASSERT_TRUE(wait_for_attempt(9s));
  const Duration first = connected_at.back() - told;
  ends.clear();
  connected_at.clear();
  start_streaming();  // same seed, same draw: without the early close
  const PhoneTime again = clock.now();
  far().say(GoAway{8s, "restart"});
  ASSERT_TRUE(wait_for_attempt(9s));
  EXPECT_NEAR(seconds(first), seconds(connected_at.back() - again), 2e-3);
}

TEST_F(ClientConnection, WaitsAsLongAsAnOverloadedServerAsks) {
  make();
  client->start();
  far().open();
  far().say(FaultReport{{FaultCode::kOverloaded, "", "full"}, 0, {}, 12s});
  EXPECT_EQ(client->state(), kBackingOff);
  const PhoneTime told = clock.now();
  ASSERT_TRUE(wait_for_attempt());
  EXPECT_GE(connected_at.back() - told, 12s);
  EXPECT_LE(connected_at.back() - told, 12s + 501ms);
}

TEST_F(ClientConnection, ReconnectsAtOnceWhenTheNetworkChanged) {
  start_streaming();
  client->network_changed();
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_TRUE(ends[0]->closed);
  far().open();
  ASSERT_TRUE(far().all<Hello>().at(0).resume);
  far().drop();
  ASSERT_EQ(client->state(), kBackingOff);
  client->network_changed();
  EXPECT_EQ(ends.size(), 3u);
  EXPECT_EQ(client->state(), kConnecting);
}

TEST_F(ClientConnection, EventsOfAnEarlierLinkAreNotHeard) {
  start_streaming();
  client->network_changed();
  FarEnd& old = *ends[0];
  old.drop();
  old.say(recovered(5));
  EXPECT_EQ(client->state(), kConnecting);
  EXPECT_EQ(ends.size(), 2u);
}

TEST_F(ClientConnection, SaysGoodbyeAfterWhatWaits) {
  start_streaming();
  walk(3);
  run(2);
  walk(2);
  client->stop();
  EXPECT_EQ(far().sequences(), numbers(1, 5));
  EXPECT_TRUE(std::holds_alternative<Goodbye>(far().heard.back()));
  EXPECT_TRUE(far().closed);
  EXPECT_EQ(client->state(), kEnded);
  EXPECT_FALSE(client->send(step()));
}

TEST_F(ClientConnection, MayBeStoppedAndDestroyedFromItsOwnCallbacks) {
  for (const ClientState moment : {kConnecting, kGreeting, kStreaming, kBackingOff}) {
    for (const bool destroy : {false, true}) {
      on_state = [&](ClientState state) {
        if (state != moment) return;
        if (destroy) {
          client.reset();
        } else {
          client->stop();
        }
      };
      make();
      Client* raw = client.get();
      raw->start();
      if (client && client->state() == kConnecting) far().open();
      if (client && client->state() == kGreeting) far().say(fresh());
      if (client && client->state() == kStreaming) far().drop();
      if (!destroy) {
        EXPECT_EQ(client->state(), kEnded);
      }
      clock.run_for(2min);
      if (!destroy) {
        EXPECT_EQ(client->state(), kEnded);
      }
      on_state = nullptr;
      client.reset();
      clock.run_for(2min);
      EXPECT_EQ(clock.waiting(), 0u) << "a timer was left behind";
      for (const auto& end : ends) EXPECT_TRUE(end->destroyed);
    }
  }
}

}  // namespace
}  // namespace wayfuse
