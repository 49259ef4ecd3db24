// Sessions over a real socket, driven by a WebSocket client that shares no code with server or SDK.
#include <gtest/gtest.h>
#include <signal.h>

#include <vector>

#include "tests/integration/running_server.hpp"

namespace wayfuse {
namespace {

class Sessions : public AnyServer {};
class OwnSessions : public RunningServer {};

TEST_F(Sessions, ASurveyedBuildingGivesPositionsInBothEncodings) {
  start();
  make_building("Hall");
  survey(building);
  for (const std::string_view spoken : {kSubprotocolJson, kSubprotocolCbor}) {
    RawWebsocket phone(where(), key, spoken);
    ASSERT_EQ(phone.status(), 101) << phone.answer();
    phone.send(hello(Role::kTrack, building));
    const auto welcome = phone.expect<Welcome>();
    ASSERT_TRUE(welcome);
    EXPECT_EQ(welcome->building_name, "Hall");
    phone.send(scans(1, 2));
    EXPECT_EQ(phone.expect<Ack>()->through, 2u);
    const auto position = phone.expect<Position>();
    ASSERT_TRUE(position);
    EXPECT_LT(distance_m(position->position.place.point, {20, 4}), 4.0);
    phone.send(Goodbye{"done"});
    EXPECT_EQ(phone.close_code(), 1000);
  }
}

TEST_F(Sessions, APhoneThatSendsTooFastIsHeldBackAndLosesNothing) {
  start();
  make_building("Hall");
  survey(building);
  RawWebsocket phone(where(), key);
  phone.send(hello(Role::kTrack, building));
  ASSERT_TRUE(phone.expect<Welcome>());
  // Each waits for its answer, so that nothing is on its way when the reading pauses.
  for (std::uint64_t number = 1; number <= 1100; ++number) {  // 1,000 at once are allowed
    ASSERT_TRUE(phone.send(scans(number, 1)));
    const auto ack = phone.expect<Ack>();
    ASSERT_TRUE(ack) << "number " << number;
    ASSERT_EQ(ack->through, number);
  }
}

TEST_F(OwnSessions, AWalkGoesOverToTheNewerMapAndBackAtARollback) {
  start({"--limits.arrivals_burst", "100000"});  // it asks whether the map is there, each time over a connection of its own
  make_building("Hall");
  const std::string path = "/v1/buildings/" + std::to_string(building);
  RawWebsocket surveyor(where(), key);
  surveyor.send(hello(Role::kSurvey, building));
  const auto upload = [&](const std::string& name, auto belongs) {
    SurveyBatch part = batch(name);
    std::erase_if(part.points, [&](const ReferencePoint& point) { return !belongs(point.place.point.x_m); });
    surveyor.send(part);
    ASSERT_TRUE(surveyor.expect<SurveyAck>());
  };
  upload("west", [](double x_m) { return x_m < 22.0; });
  await_map(building, 1);
  RawWebsocket phone(where(), key);
  phone.send(hello(Role::kTrack, building));
  ASSERT_TRUE(phone.expect<Welcome>());
  std::uint64_t sent = 0;
  const auto walk = [&] {  // three scans, a second of evidence apart
    phone.send(scans(sent + 1, 3));
    sent += 3;
    const auto position = phone.expect<Position>();
    return position ? position->position.radio_map_version : 0;
  };
  EXPECT_EQ(walk(), 1u);
  upload("east", [](double x_m) { return x_m >= 22.0; });
  const auto built = http(where(), "POST", path + "/maps", key, "{}");
  EXPECT_EQ(built.status, 201) << built.body;
  const auto promoted = http(where(), "POST", path + "/maps/2/promotion", key, R"({"expected_live":1,"reason":"test"})");
  EXPECT_EQ(promoted.status, 201) << promoted.body;
  await_map(building, 2);
  EXPECT_EQ(walk(), 2u) << "the session still has the map of half the survey";
  EXPECT_EQ(http(where(), "POST", path + "/maps/rollback", key, R"({"reason":"test"})").status, 201);
  await_map(building, 1);
  EXPECT_EQ(walk(), 1u);
}

TEST_F(Sessions, AReplayGivesWhatThePhoneWasToldOverTheSocket) {
  start();
  make_building("Hall");
  survey(building);
  const std::string path = "/v1/buildings/" + std::to_string(building);
  RawWebsocket phone(where(), key);
  phone.send(hello(Role::kTrack, building));
  ASSERT_TRUE(phone.expect<Welcome>());
  phone.send(scans(1, 3));
  ASSERT_TRUE(phone.expect<Position>());
  ASSERT_EQ(http(where(), "PUT", path + "/recording", key, R"({"on_for_s":600})").status, 200);
  for (std::uint64_t number = 4; number <= 13; number += 2) {
    phone.send(scans(number, 2));
    ASSERT_TRUE(phone.expect<Position>());
  }
  const auto listed = http(where(), "GET", path + "/recordings", key);
  EXPECT_NE(listed.body.find("\"steps\":5,"), std::string::npos) << listed.body;
  const std::string mark = "\"id\":";
  const auto id = std::to_string(std::strtoull(listed.body.c_str() + listed.body.find(mark) + mark.size(), nullptr, 10));
  const auto again = http(where(), "POST", path + "/recordings/" + id + "/replay", key, "{}");
  ASSERT_EQ(again.status, 200) << again.body;
  for (const char* said : {"\"as_it_was\":true", "\"steps_in_all\":5", "\"differing\":0", "\"as_live\":true"}) {
    EXPECT_NE(again.body.find(said), std::string::npos) << said << " is not in " << again.body;
  }
  const auto content = http(where(), "GET", path + "/recordings/" + id, key);
  EXPECT_NE(content.body.find("\"sequence\":4,"), std::string::npos) << content.body;
  EXPECT_NE(content.body.find("\"sequence\":13,"), std::string::npos) << content.body;
  EXPECT_EQ(http(where(), "DELETE", path + "/recordings", key).body, "{\"erased\":1}");
}

TEST_F(Sessions, ResumeAfterABrokenConnection) {
  start();
  make_building("Hall");
  survey(building);
  std::optional<Welcome> first;
  {
    RawWebsocket phone(where(), key);
    phone.send(hello(Role::kTrack, building));
    first = phone.expect<Welcome>();
    phone.send(scans(1, 3));
    ASSERT_TRUE(phone.expect<Ack>());
  }
  RawWebsocket phone(where(), key);
  Hello again = hello(Role::kTrack, building);
  again.resume = Resume{first->session, first->epoch, 2, {}};
  phone.send(again);
  const auto welcome = phone.expect<Welcome>();
  ASSERT_TRUE(welcome);
  EXPECT_TRUE(welcome->recovered);
  EXPECT_EQ(welcome->applied_through, 3u);
}

TEST_F(Sessions, BeginInABuildingAsSoonAsItsMakingIsAnswered) {
  start();
  for (int i = 0; i < 20; ++i) {
    make_building("Hall " + std::to_string(i));
    RawWebsocket phone(where(), key);
    phone.send(hello(Role::kTrack, building));
    ASSERT_TRUE(phone.expect<Welcome>()) << "building " << building << " was made and is not served";
  }
}

TEST_F(Sessions, APhoneTracksOnTokensItRenewsAndNotBeyond) {
  start();
  make_building("Hall");
  survey(building);
  const auto token = [&](const std::string& body) {
    const auto answer = http(where(), "POST", "/v1/buildings/" + std::to_string(building) + "/session-tokens", key, body);
    EXPECT_EQ(answer.status, 201) << answer.body;
    const std::size_t at = answer.body.find("ws_");
    return answer.body.substr(at, answer.body.find('"', at) - at);
  };
  RawWebsocket phone(where(), token(R"({"lifetime_s":60})"));
  phone.send(hello(Role::kTrack, building));
  const auto welcome = phone.expect<Welcome>();
  ASSERT_TRUE(welcome);
  EXPECT_GT(welcome->token_expires_in, Duration{0});
  EXPECT_LE(welcome->token_expires_in, std::chrono::seconds(60));
  phone.send(TokenRefresh{token("{}")});
  const auto accepted = phone.expect<TokenAccepted>();
  ASSERT_TRUE(accepted);
  EXPECT_GT(accepted->expires_in, std::chrono::seconds(600));
  phone.send(scans(1, 2));
  EXPECT_TRUE(phone.expect<Position>());

  RawWebsocket brief(where(), token(R"({"lifetime_s":1})"));
  brief.send(hello(Role::kTrack, building));
  ASSERT_TRUE(brief.expect<Welcome>());
  const auto ended = brief.expect<FaultReport>();
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->fault.code, FaultCode::kNotAuthenticated);

  RawWebsocket surveyor(where(), token("{}"));
  surveyor.send(hello(Role::kSurvey, building));
  const auto refused = surveyor.expect<FaultReport>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->fault.code, FaultCode::kNotAllowed);
}

TEST_F(Sessions, AnObserverSeesThePhone) {
  start();
  make_building("Hall");
  survey(building);
  RawWebsocket observer(where(), key);
  observer.send(hello(Role::kObserve, building));
  ASSERT_TRUE(observer.expect<Welcome>());
  observer.send(Subscribe{});
  RawWebsocket phone(where(), key);
  phone.send(hello(Role::kTrack, building));
  phone.send(scans(1, 2));
  ASSERT_TRUE(phone.expect<Position>());
  const auto seen = observer.expect<Observation>();
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->tracked.at(0).position.building, BuildingId{building});
}

TEST_F(Sessions, EmptyMapAndUnknownBuildingAreNamed) {
  start();
  make_building("Empty");
  RawWebsocket phone(where(), key);
  phone.send(hello(Role::kTrack, building));
  phone.send(scans(1, 1));
  const auto reason = phone.expect<NoFix>();
  ASSERT_TRUE(reason);
  EXPECT_EQ(reason->reason.code, FaultCode::kEmptyRadioMap);

  RawWebsocket lost(where(), key);
  lost.send(hello(Role::kTrack, 47'110'815));
  EXPECT_EQ(lost.expect<FaultReport>()->fault.code, FaultCode::kUnknownBuilding);
  EXPECT_EQ(lost.close_code(), 1008);
}

TEST_F(Sessions, KeysAreRefusedInTheHeaderAndInTheHello) {
  start();
  make_building("Hall");
  EXPECT_EQ(RawWebsocket(where(), "wf_wrong").status(), 401);
  RawWebsocket wrong(where(), "");
  ASSERT_EQ(wrong.status(), 101);
  Hello with_token = hello(Role::kTrack, building);
  with_token.token = "wf_wrong";
  wrong.send(with_token);
  EXPECT_EQ(wrong.expect<FaultReport>()->fault.code, FaultCode::kNotAuthenticated);
  EXPECT_EQ(wrong.close_code(), 1008);
  RawWebsocket right(where(), "");
  with_token.token = key;
  right.send(with_token);
  EXPECT_TRUE(right.expect<Welcome>());
}

TEST_F(OwnSessions, TooManyWrongKeysAreNotEvenLookedAt) {
  start({"--limits.refusals_burst", "3", "--limits.refusals_per_address", "0.01"});
  for (int i = 0; i < 3; ++i) EXPECT_EQ(http(port(), "GET", "/v1/buildings", "wf_wrong").status, 401);
  EXPECT_EQ(http(port(), "GET", "/v1/buildings", "wf_wrong").status, 429);
  EXPECT_EQ(http(port(), "GET", "/healthz").status, 200);
}

TEST_F(OwnSessions, DrainTellsEverybodyAndLeavesInOrder) {
  start({"--server.drain_s", "0.5"});
  make_building("Hall");
  survey(1);
  RawWebsocket phone(port(), key);
  phone.send(hello(Role::kTrack, 1));
  ASSERT_TRUE(phone.expect<Welcome>());
  server->signal(SIGTERM);
  EXPECT_TRUE(phone.expect<GoAway>());
  phone.send(scans(1, 1));  // what is still sent is still answered
  EXPECT_TRUE(phone.expect<Ack>());
  EXPECT_EQ(phone.close_code(), 1001);
  EXPECT_EQ(server->wait(10), 0);
}

TEST_F(OwnSessions, DrainSendsTwoThousandAwayOneByOne) {
  start({"--limits.arrivals_burst", "10000"});
  make_building("Hall");
  std::vector<RawWebsocket> phones;
  for (int i = 0; i < 2'000; ++i) {
    phones.emplace_back(where(), key);
    phones.back().send(hello(Role::kTrack, building));
    ASSERT_TRUE(phones.back().expect<Welcome>()) << i;
  }
  server->signal(SIGTERM);
  int told = 0, closed_in_order = 0;
  for (RawWebsocket& phone : phones) {
    told += phone.expect<GoAway>().has_value();
    closed_in_order += phone.close_code() == 1001;
  }
  EXPECT_EQ(told, 2'000);
  EXPECT_EQ(closed_in_order, 2'000);
  EXPECT_EQ(server->wait(30), 0);
}

TEST_F(OwnSessions, NothingAcknowledgedIsLostByKill9) {
  start();
  make_building("Hall");
  std::set<std::string> acked;
  std::set<std::string> sent;
  for (int round = 0; round < 5; ++round) {
    RawWebsocket surveyor(port(), key);
    surveyor.send(hello(Role::kSurvey, 1));
    ASSERT_TRUE(surveyor.expect<Welcome>());
    for (int i = 0; i < 6; ++i) {
      const std::string name = "r" + std::to_string(round) + "-" + std::to_string(i);
      sent.insert(name);
      surveyor.send(batch(name));
    }
    for (int i = 0; i < round; ++i) {  // killed while the rest is on its way
      const auto ack = surveyor.expect<SurveyAck>();
      ASSERT_TRUE(ack);
      acked.insert(ack->idempotency_key);
    }
    server->signal(SIGKILL);
    EXPECT_EQ(server->wait(10), 128 + SIGKILL);
    start();
  }
  RawWebsocket surveyor(port(), key);
  surveyor.send(hello(Role::kSurvey, 1));
  for (const std::string& name : sent) {  // unknown or not: once more, same key
    surveyor.send(batch(name));
    ASSERT_TRUE(surveyor.expect<SurveyAck>());
  }
  const auto exported = http(port(), "GET", "/v1/buildings/1", key);
  EXPECT_NE(exported.body.find("\"points\":" + std::to_string(33 * sent.size())), std::string::npos) << exported.body;
  EXPECT_FALSE(acked.empty());
}

}  // namespace
}  // namespace wayfuse
