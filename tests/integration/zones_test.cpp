#include <signal.h>

#include "tests/integration/running_server.hpp"

namespace wayfuse {
namespace {

/// A server whose zones believe a position at once, with a hall inside a zone.
class Zones : public RunningServer {
 protected:
  void SetUp() override {
    start({"--zones.settle_m", "0", "--zones.settle_at_rest_s", "0"});
    make_building("Hall");
    survey(1);
    const auto made = http(port(), "POST", "/v1/buildings/1/zones", key,
                           R"({"name":"All","floor":0,"region":[[[-500,-500],[500,-500],[500,500],[-500,500]]]})");
    ASSERT_EQ(made.status, 201) << made.body;
  }
  // A follower of the events over plain HTTP.
  RawSocket follow(const std::string& more = "") {
    RawSocket socket(port());
    socket.send("GET /v1/buildings/1/events HTTP/1.1\r\nHost: a\r\nAuthorization: Bearer " + key + "\r\n" + more + "\r\n");
    const auto head = socket.read_until("\r\n\r\n");
    EXPECT_TRUE(head && head->find("text/event-stream") != std::string::npos) << head.value_or("no answer");
    EXPECT_TRUE(head && head->find("chunked") != std::string::npos);
    return socket;
  }
  static Subscribe zone_events() {
    Subscribe subscribe;
    subscribe.positions = false;
    subscribe.zone_events = true;
    return subscribe;
  }
};

TEST_F(Zones, ReachObserversAndFollowersAndGoOnBehindTheLastEvent) {
  RawWebsocket observer(port(), key);
  observer.send(hello(Role::kObserve, 1));
  ASSERT_TRUE(observer.expect<Welcome>());
  observer.send(zone_events());
  observer.send(ClockProbe{});
  ASSERT_TRUE(observer.expect<ClockAnswer>());
  RawSocket follower = follow();
  ASSERT_TRUE(follower.read_until("retry: 2000\n\n"));

  RawWebsocket phone(port(), key);
  phone.send(hello(Role::kTrack, 1));
  ASSERT_TRUE(phone.expect<Welcome>());
  phone.send(scans(1, 3));
  phone.send(scans(4, 3));
  phone.send(scans(7, 3));
  const auto entered = observer.expect<ZoneEvent>();
  ASSERT_TRUE(entered);
  EXPECT_EQ(entered->zone_name, "All");
  EXPECT_EQ(entered->transition, ZoneTransition::kEntered);
  EXPECT_GE(entered->probability, 0.9);
  const auto told = follower.read_until("\n\n\r\n");
  ASSERT_TRUE(told);
  EXPECT_NE(told->find("id: " + entered->id + "\nevent: zone_event\ndata: {"), std::string::npos) << *told;
  EXPECT_NE(http(port(), "GET", "/v1/buildings/1/zones/1/occupants", key).body.find(entered->tracked), std::string::npos);

  phone.send(Goodbye{});
  const auto left = observer.expect<ZoneEvent>();
  ASSERT_TRUE(left);
  EXPECT_EQ(left->transition, ZoneTransition::kLeft);
  RawSocket late = follow("Last-Event-ID: " + entered->id + "\r\n");
  const auto rest = late.read_until("\n\n\r\n");
  ASSERT_TRUE(rest);
  EXPECT_NE(rest->find("id: " + left->id + "\n"), std::string::npos) << *rest;
  EXPECT_EQ(rest->find("id: " + entered->id + "\n"), std::string::npos);
  EXPECT_NE(http(port(), "GET", "/metrics", key).body.find("wayfuse_zone_entries_total 1\n"), std::string::npos);
}

TEST_F(Zones, KeepNobodyFromGoingDown) {
  RawSocket follower = follow();
  ASSERT_TRUE(follower.read_until("retry: 2000\n\n"));
  server->signal(SIGTERM);
  const auto end = follower.read_until("0\r\n\r\n");
  EXPECT_TRUE(end) << "the last chunk: the body is whole";
  EXPECT_EQ(server->wait(10), 0);
}

TEST_F(Zones, AreAllACoarseObserverSees) {
  const auto made = http(port(), "POST", "/v1/keys", key, R"({"name":"desk","scopes":["observe"],"building":1,"coarse":true})");
  ASSERT_EQ(made.status, 201) << made.body;
  const auto begin = made.body.find("wf_");
  const std::string coarse = made.body.substr(begin, made.body.find('"', begin) - begin);
  RawWebsocket observer(port(), coarse);
  observer.send(hello(Role::kObserve, 1));
  ASSERT_TRUE(observer.expect<Welcome>());
  observer.send(Subscribe{});
  const auto refused = observer.expect<FaultReport>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->fault.code, FaultCode::kNotAllowed);
  EXPECT_EQ(refused->fault.field, "positions");
  observer.send(zone_events());
  RawWebsocket phone(port(), key);
  phone.send(hello(Role::kTrack, 1));
  phone.send(scans(1, 3));
  phone.send(scans(4, 3));
  phone.send(scans(7, 3));
  while (const auto message = observer.receive()) {
    EXPECT_FALSE(std::holds_alternative<Observation>(*message));
    if (std::holds_alternative<ZoneEvent>(*message)) break;
  }
  EXPECT_EQ(http(port(), "GET", "/v1/buildings/1/sessions", coarse).body.find("position"), std::string::npos);
}

}  // namespace
}  // namespace wayfuse
