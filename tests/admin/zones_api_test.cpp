#include "tests/admin/running_api.hpp"

namespace wayfuse {
namespace {

using nlohmann::json;

const char* const kLab = R"({"name":"Lab","floor":1,"region":[[[0,0],[10,0],[10,8],[0,8]]],"exit_tolerance_m":1.5,"tolerance_timeout_us":5000000,"exit_delay_us":-1})";

class ZonesApi : public testing::Test {
 protected:
  ZonesApi() {
    api.ask("POST", "/v1/buildings", api.admin, R"({"name":"One"})");
    api.ask("POST", "/v1/buildings", api.admin, R"({"name":"Two"})");
  }
  // A phone that stands at a point for two minutes.
  void stand(const std::string& tracked, double x_m, double y_m, std::int32_t floor = 1) {
    FusedPosition position;
    position.building = {1};
    position.place = {{x_m, y_m}, {floor}};
    position.floors = {{{floor}, 1.0}};
    position.covariance = {0.25, 0, 0.25};
    position.radius95_m = 1.2;
    for (int i = 0; i < 60; ++i) {
      api.clock.shift += std::chrono::seconds(2);
      position.valid_at = PhoneTime(api.clock.shift);
      api.zones->moved(tracked, position);
    }
  }
  RunningApi api;
};

TEST_F(ZonesApi, GivesBackTheZoneItWasGivenAndReplacesAndRemovesIt) {
  const auto made = api.ask("POST", "/v1/buildings/1/zones", api.admin, kLab);
  ASSERT_EQ(made.status, 201) << made.body;
  EXPECT_EQ(made.headers.at("location"), "/v1/buildings/1/zones/1");
  json expected = json::parse(kLab);
  expected["id"] = 1;
  expected["exit_delay_us"] = nullptr;  // -1 is omlox's word for ever
  expected["timeout_us"] = nullptr;
  EXPECT_EQ(made.json(), expected);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/zones/1", api.admin).json(), expected);

  const auto replaced = api.ask("PUT", "/v1/buildings/1/zones/1", api.admin, R"({"name":"Store","floor":0,"region":[[[0,0],[4,0],[4,4]]]})");
  ASSERT_EQ(replaced.status, 200) << replaced.body;
  EXPECT_EQ(replaced.json()["name"], "Store");
  EXPECT_EQ(replaced.json()["exit_delay_us"], 0);
  EXPECT_EQ(api.ask("DELETE", "/v1/buildings/1/zones/1", api.admin).status, 204);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/zones/1", api.admin).status, 404);
  EXPECT_EQ(api.ask("DELETE", "/v1/buildings/1/zones/1", api.admin).status, 404);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/zones/x", api.admin).status, 404);
}

TEST_F(ZonesApi, PagesThroughZonesAndKnowsFloors) {
  for (int i = 0; i < 5; ++i) {
    const std::string body = R"({"name":"Z","floor":)" + std::to_string(i % 2) + R"(,"region":[[[0,0],[4,0],[4,4]]]})";
    ASSERT_EQ(api.ask("POST", "/v1/buildings/1/zones", api.admin, body).status, 201);
  }
  const json first = api.ask("GET", "/v1/buildings/1/zones?most=3", api.admin).json();
  EXPECT_EQ(first["zones"].size(), 3u);
  const json rest = api.ask("GET", "/v1/buildings/1/zones?most=3&after=" + first["next"].dump(), api.admin).json();
  EXPECT_EQ(rest["zones"].size(), 2u);
  EXPECT_FALSE(rest.contains("next"));
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/zones?floor=1", api.admin).json()["zones"].size(), 2u);
}

TEST_F(ZonesApi, NamesTheFieldItRefuses) {
  const std::pair<const char*, const char*> cases[] = {
      {"{", ""},
      {R"({"floor":0,"region":[[[0,0],[4,0],[4,4]]]})", "name"},
      {R"({"name":"","floor":0,"region":[[[0,0],[4,0],[4,4]]]})", "name"},
      {R"({"name":"a","region":[[[0,0],[4,0],[4,4]]]})", "floor"},
      {R"({"name":"a","floor":0.5,"region":[[[0,0],[4,0],[4,4]]]})", "floor"},
      {R"({"name":"a","floor":0,"region":[]})", "region"},
      {R"({"name":"a","floor":0,"region":[[[0,0],[4,0]]]})", "region[0]"},
      {R"({"name":"a","floor":0,"region":[[[0,0],[4,4],[4,0],[0,4]]]})", "region[0]"},  // a bow tie
      {R"({"name":"a","floor":0,"region":[[[0,0],[4,0],[4,4]]],"exit_tolerance_m":-1})", "exit_tolerance_m"},
      {R"({"name":"a","floor":0,"region":[[[0,0],[4,0],[4,4]]],"timeout_us":-2})", "timeout_us"},
      {R"({"name":"a","floor":0,"region":[[[0,0],[4,0],[4,4]]],"exit_delay_us":"1 s"})", "exit_delay_us"},
  };
  for (const auto& [body, field] : cases) {
    const auto answer = api.ask("POST", "/v1/buildings/1/zones", api.admin, body);
    EXPECT_GE(answer.status, 400) << body;
    EXPECT_EQ(answer.json().value("field", ""), field) << answer.body;
  }
}

TEST_F(ZonesApi, ReplacesOnlyTheVersionThatWasRead) {
  const auto made = api.ask("POST", "/v1/buildings/1/zones", api.admin, kLab);
  const std::string etag = made.headers.at("etag");
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/zones/1", api.admin).headers.at("etag"), etag);
  const auto known = api.ask("GET", "/v1/buildings/1/zones/1", api.admin, "", {{"if-none-match", etag}});
  EXPECT_EQ(known.status, 304);
  EXPECT_TRUE(known.body.empty());
  const char* const kStore = R"({"name":"Store","floor":0,"region":[[[0,0],[4,0],[4,4]]]})";
  const auto first = api.ask("PUT", "/v1/buildings/1/zones/1", api.admin, kStore, {{"if-match", etag}});
  EXPECT_EQ(first.status, 200) << first.body;
  const auto second = api.ask("PUT", "/v1/buildings/1/zones/1", api.admin, kLab, {{"if-match", etag}});
  EXPECT_EQ(second.status, 412);
  EXPECT_EQ(second.json()["field"], "If-Match");
  EXPECT_EQ(api.ask("DELETE", "/v1/buildings/1/zones/1", api.admin, "", {{"if-match", etag}}).status, 412);
  EXPECT_EQ(api.ask("DELETE", "/v1/buildings/1/zones/1", api.admin, "", {{"if-match", first.headers.at("etag")}}).status, 204);
}

TEST_F(ZonesApi, MakesAZoneOnceUnderOneIdempotencyKey) {
  const std::map<std::string, std::string> once = {{"idempotency-key", "zone-1"}};
  const auto first = api.ask("POST", "/v1/buildings/1/zones", api.admin, kLab, once);
  const auto again = api.ask("POST", "/v1/buildings/1/zones", api.admin, kLab, once);
  EXPECT_EQ(again.status, 201);
  EXPECT_EQ(again.body, first.body);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/zones", api.admin).json()["zones"].size(), 1u);
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/zones", api.admin, "{}", once).status, 409);
  EXPECT_EQ(api.ask("POST", "/v1/buildings/2/zones", api.admin, kLab, once).status, 201) << "another path, another matter";
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/zones", api.admin, kLab, {{"idempotency-key", "a b"}}).status, 422);
  api.clock.shift += std::chrono::hours(25);
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/zones", api.admin, kLab, once).json()["id"], 2) << "a day later it is forgotten";
}

TEST_F(ZonesApi, TellsWhoIsInside) {
  api.ask("POST", "/v1/buildings/1/zones", api.admin, kLab);
  stand("phone-a", 5, 4);
  stand("phone-b", 30, 4);
  const json inside = api.ask("GET", "/v1/buildings/1/zones/1/occupants", api.admin).json()["occupants"];
  ASSERT_EQ(inside.size(), 1u);
  EXPECT_EQ(inside[0]["tracked"], "phone-a");
  EXPECT_GT(inside[0]["probability"], 0.9);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/zones/9/occupants", api.admin).status, 404);
}

TEST_F(ZonesApi, StreamsEventsAndGoesOnBehindTheLastOneSeen) {
  api.ask("POST", "/v1/buildings/1/zones", api.admin, kLab);
  const auto stream = api.ask("GET", "/v1/buildings/1/events", api.admin);
  ASSERT_EQ(stream.status, 200);
  EXPECT_EQ(stream.content_type, "text/event-stream");
  ASSERT_TRUE(stream.stream);
  int woken = 0;
  stream.stream->on_ready([&] { ++woken; });
  EXPECT_EQ(stream.stream->next(), "retry: 2000\n\n");
  EXPECT_EQ(stream.stream->next(), "");
  stand("phone-a", 5, 4);
  EXPECT_EQ(woken, 1);
  const std::string told = stream.stream->next().value();
  EXPECT_NE(told.find("id: 1000-1\nevent: zone_event\ndata: {"), std::string::npos) << told;
  EXPECT_NE(told.find(R"("transition":"entered")"), std::string::npos) << told;
  EXPECT_EQ(stream.stream->next(), "");
  api.zones->gone("phone-a");

  const auto resumed = api.ask("GET", "/v1/buildings/1/events", api.admin, "", {{"last-event-id", "1000-1"}});
  const std::string rest = resumed.stream->next().value();
  EXPECT_EQ(rest.find("id: 1000-1\n"), std::string::npos);
  EXPECT_NE(rest.find("id: 1000-2\n"), std::string::npos) << rest;
  EXPECT_EQ(rest.find("missed"), std::string::npos);
  const auto restarted = api.ask("GET", "/v1/buildings/1/events", api.admin, "", {{"last-event-id", "999-40"}});
  EXPECT_NE(restarted.stream->next()->find("event: missed"), std::string::npos);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/events", api.admin, "", {{"last-event-id", "yesterday"}}).status, 422);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/2/events", api.admin, "", {{"last-event-id", "1000-0"}}).stream->next(), "retry: 2000\n\n")
      << "another building's events are its own";
}

TEST_F(ZonesApi, EndsAStreamWhoseKeyWasRevoked) {
  const std::string key = api.issue({Scope::kObserve}, {1});
  const auto stream = api.ask("GET", "/v1/buildings/1/events", key).stream;
  stream->next();
  EXPECT_EQ(stream->idle(), "");
  api.clock.shift += std::chrono::seconds(16);
  EXPECT_EQ(stream->idle(), ": alive\n\n");
  const auto keys = api.store->keys();
  ASSERT_TRUE(api.keys->revoke(keys->back().id));
  api.clock.shift += std::chrono::seconds(16);
  EXPECT_EQ(stream->idle(), std::nullopt);
}

TEST_F(ZonesApi, ShowsACoarseKeyZonesAndNeverACoordinate) {
  api.ask("POST", "/v1/buildings/1/zones", api.admin, kLab);
  stand("phone-1", 5, 4);
  const std::string coarse = api.issue({Scope::kObserve}, {1}, {}, true);
  int open = 0;
  for (const Route& route : api.router->routes()) {
    if (route.scope != Scope::kObserve || route.method != "GET") continue;
    std::string path = route.pattern;
    for (const auto& [name, value] : std::map<std::string, std::string>{{"{building}", "1"}, {"{zone}", "1"}, {"{pipeline}", "p1"}}) {
      if (const auto at = path.find(name); at != std::string::npos) path.replace(at, name.size(), value);
    }
    const auto answer = api.ask("GET", path, coarse);
    if (route.coarse) {
      if (path.find("{") == std::string::npos && path.find("/buildings/") != std::string::npos) {
        EXPECT_EQ(answer.status, 200) << path << answer.body;
      }
      EXPECT_EQ(answer.body.find("\"position\""), std::string::npos) << path << answer.body;
      ++open;
    } else {
      EXPECT_EQ(answer.status, 403) << path;
    }
  }
  EXPECT_GE(open, 6);
  const json session = api.ask("GET", "/v1/buildings/1/sessions", coarse).json()["sessions"][0];
  EXPECT_EQ(session["zones"], json::array({"Lab"}));
  const auto refused = api.ask("POST", "/v1/keys", api.admin, R"({"name":"a","scopes":["admin"],"coarse":true})");
  EXPECT_EQ(refused.json()["field"], "coarse");
}

TEST_F(ZonesApi, WritesDownWhoReadAndWhoChangedBeforeItAnswers) {
  const auto lines = [&] { return api.store->audited({}).value(); };
  const std::size_t before = lines().size();
  const std::string key = api.issue({Scope::kObserve}, {1});
  api.ask("GET", "/v1/buildings/1/sessions", key);
  ASSERT_EQ(lines().size(), before + 1);
  EXPECT_EQ(lines().back().action, "GET sessions");
  EXPECT_EQ(lines().back().building.value, 1u);
  api.ask("GET", "/v1/buildings/1/sessions", key);
  EXPECT_EQ(lines().size(), before + 1) << "the same reading within a minute is one line";
  api.clock.shift += std::chrono::seconds(61);
  api.ask("GET", "/v1/buildings/1/sessions", key);
  EXPECT_EQ(lines().size(), before + 2);
  api.ask("DELETE", "/v1/buildings/1/zones/77", api.admin);
  EXPECT_EQ(lines().back().action, "DELETE zones/{zone}");
  EXPECT_EQ(lines().back().subject, "zone 77");
  api.store->close();
  EXPECT_EQ(api.ask("GET", "/v1/buildings/2/sessions", api.admin).status, 503) << "what cannot be written down is not shown";
}

}  // namespace
}  // namespace wayfuse
