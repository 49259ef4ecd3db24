#include <algorithm>

#include "tests/admin/running_api.hpp"

namespace wayfuse {
namespace {

TEST(KeysApi, ShowsAKeyOnceAndStoresOnlyItsHash) {
  RunningApi api;
  const auto made = api.ask("POST", "/v1/keys", api.admin, R"({"name":"surveyor","scopes":["survey"],"building":3})");
  ASSERT_EQ(made.status, 201) << made.body;
  EXPECT_EQ(made.headers.at("cache-control"), "no-store");
  const std::string key = made.json()["key"];
  EXPECT_GE(key.size(), 43u);
  const std::string list = api.ask("GET", "/v1/keys", api.admin).body;
  EXPECT_EQ(list.find(key), std::string::npos);
  const auto stored = api.store->keys();
  ASSERT_EQ(stored->size(), 2u);
  for (const KeyRecord& record : *stored) {
    EXPECT_EQ(record.keyed_hash.size(), 32u);
    EXPECT_EQ(record.keyed_hash.find(key), std::string::npos);
  }
}

TEST(KeysApi, RefusesARevokedAndAnExpiredKey) {
  RunningApi api;
  const auto made = api.ask("POST", "/v1/keys", api.admin, R"({"name":"short","scopes":["admin"],"expires_in_s":60})");
  const std::string key = made.json()["key"];
  EXPECT_EQ(api.ask("GET", "/v1/buildings", key).status, 200);
  api.clock.shift = std::chrono::seconds(61);
  EXPECT_EQ(api.ask("GET", "/v1/buildings", key).status, 401);

  const auto other = api.ask("POST", "/v1/keys", api.admin, R"({"name":"gone","scopes":["admin"]})").json();
  EXPECT_EQ(api.ask("GET", "/v1/buildings", other["key"]).status, 200);
  EXPECT_EQ(api.ask("DELETE", "/v1/keys/" + std::to_string(other["id"].get<int>()), api.admin).status, 204);
  EXPECT_EQ(api.ask("GET", "/v1/buildings", other["key"]).status, 401);
  EXPECT_EQ(api.ask("DELETE", "/v1/keys/9999", api.admin).status, 404);
}

TEST(KeysApi, NamesWhatIsWrongWithARequest) {
  RunningApi api;
  const std::pair<const char*, const char*> cases[] = {
      {"{", ""},
      {R"({"scopes":["survey"]})", "name"},
      {R"({"name":"a"})", "scopes"},
      {R"({"name":"a","scopes":[]})", "scopes"},
      {R"({"name":"a","scopes":["root"]})", "scopes[0]"},
      {R"({"name":"a","scopes":["survey"],"building":-1})", "building"},
      {R"({"name":"a","scopes":["survey"],"expires_in_s":0})", "expires_in_s"},
  };
  for (const auto& [body, field] : cases) {
    const auto answer = api.ask("POST", "/v1/keys", api.admin, body);
    EXPECT_GE(answer.status, 400) << body;
    EXPECT_EQ(answer.json().value("field", ""), field) << answer.body;
  }
}

// Every route against every kind of key: who may not, does not learn whether the building exists.
TEST(Access, HoldsOverTheWholeMatrixOfRoutesScopesAndBuildings) {
  RunningApi api;
  ASSERT_EQ(api.ask("POST", "/v1/buildings", api.admin, R"({"name":"One"})").status, 201);
  ASSERT_EQ(api.ask("POST", "/v1/buildings", api.admin, R"({"name":"Two"})").status, 201);
  ASSERT_EQ(api.ask("POST", "/v1/buildings/1/zones", api.admin, R"({"name":"Z","floor":0,"region":[[[0,0],[9,0],[9,9]]]})").status, 201);
  ASSERT_EQ(api.ask("POST", "/v1/buildings/1/webhooks", api.admin, R"({"url":"https://example.org/"})").status, 201);
  ASSERT_EQ(api.ask("PUT", "/v1/buildings/1/floors", api.admin, R"({"floors":[{"ordinal":0,"outline":[[[0,0],[9,0],[9,9]]]}]})").status, 200);
  const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x01\x40\0\0\0\xf0", 24);
  ASSERT_EQ(api.ask("PUT", "/v1/buildings/1/floors/0/image", api.admin, png).status, 200);
  api.store->with_building({1}, [](Result<BuildingDatabase*> database) { EXPECT_TRUE((*database)->stage_map({0, "{}", {}, "map"})); });
  ASSERT_EQ(api.ask("POST", "/v1/buildings/1/quality-walks", api.admin, "recording").status, 201);
  const Scope scopes[] = {Scope::kTrack, Scope::kSurvey, Scope::kObserve, Scope::kAdmin};
  int refused = 0, passed = 0;
  for (const Scope held : scopes) {
    const std::string key = api.issue({held}, {1});
    std::vector<const Route*> routes;
    for (const Route& route : api.router->routes()) routes.push_back(&route);
    // What removes comes last, the building itself at the very end.
    std::ranges::stable_sort(routes, {}, [](const Route* route) {
      return route->method != "DELETE" ? 0 : route->pattern == "/v1/buildings/{building}" ? 2 : 1;
    });
    for (const Route* one : routes) {
      const Route& route = *one;
      if (route.scope == Scope::kPublic) continue;
      std::string path = route.pattern;
      const bool on_building = path.find("{building}") != std::string::npos;
      const auto fill = [](std::string text, const std::string& name, const std::string& value) {
        if (const auto at = text.find(name); at != std::string::npos) text.replace(at, name.size(), value);
        return text;
      };
      path = fill(fill(fill(path, "{pipeline}", "p1"), "{key}", "12345"), "{zone}", "1");
      path = fill(fill(fill(path, "{floor}", "0"), "{webhook}", "1"), "{tracked}", "phone-1");
      path = fill(fill(fill(path, "{version}", "1"), "{walk}", "1"), "{bssid}", "00:1b:2c:00:00:01");
      path = fill(path, "{recording}", "7");
      EXPECT_EQ(api.ask(route.method, fill(path, "{building}", "1"), "").status, 401) << route.pattern;
      EXPECT_EQ(api.ask(route.method, fill(path, "{building}", "1"), "wf_wrong").status, 401) << route.pattern;
      if (held != route.scope) {
        EXPECT_EQ(api.ask(route.method, fill(path, "{building}", "1"), key).status, 403) << route.method << path;
        ++refused;
        continue;
      }
      if (!on_building) {
        EXPECT_EQ(api.ask(route.method, path, key).status, 403) << route.method << path << ": a key for one building";
        continue;
      }
      const auto other = api.ask(route.method, fill(path, "{building}", "2"), key);
      const auto absent = api.ask(route.method, fill(path, "{building}", "77"), key);
      EXPECT_EQ(other.status, 404) << route.method << path;
      EXPECT_EQ(other.body, absent.body);
      const int own = api.ask(route.method, fill(path, "{building}", "1"), key).status;
      EXPECT_TRUE(own != 401 && own != 403 && own != 404) << route.method << path << own;
      ++passed;
    }
  }
  EXPECT_GT(refused, 30);
  EXPECT_GT(passed, 7);
}

}  // namespace
}  // namespace wayfuse
