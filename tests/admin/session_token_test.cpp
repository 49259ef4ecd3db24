#include "admin/session_token.hpp"

#include "tests/admin/running_api.hpp"

namespace wayfuse {
namespace {

TEST(SessionToken, IsReadBackOnlyAsItWasSealed) {
  const std::string secret(32, 's'), other(32, 't');
  const SessionToken token{7, {3}, UnixTime{std::chrono::seconds(1'800'000'900)}};
  const std::string text = seal(token, secret);
  EXPECT_EQ(unseal(text, secret), token);
  EXPECT_FALSE(unseal(text, other));
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string forged = text;
    forged[i] = forged[i] == 'A' ? 'B' : 'A';
    EXPECT_FALSE(unseal(forged, secret)) << i;
    EXPECT_FALSE(unseal(text.substr(0, i), secret)) << i;
  }
  EXPECT_FALSE(unseal(text + "A", secret));
}

TEST(SessionTokens, TrackInTheirBuildingAndDoNothingElse) {
  RunningApi api;
  ASSERT_EQ(api.ask("POST", "/v1/buildings", api.admin, R"({"name":"One"})").status, 201);
  const auto made = api.ask("POST", "/v1/buildings/1/session-tokens", api.admin);
  ASSERT_EQ(made.status, 201) << made.body;
  EXPECT_EQ(made.headers.at("cache-control"), "no-store");
  EXPECT_EQ(made.json()["expires_in_s"], 900.0);
  const std::string token = made.json()["token"];
  const auto principal = api.keys->principal_of(token);
  ASSERT_TRUE(principal);
  EXPECT_EQ(principal->scopes, std::vector<Scope>{Scope::kTrack});
  EXPECT_EQ(principal->building, BuildingId{1});
  EXPECT_EQ(principal->key_id, api.keys->principal_of(api.admin)->key_id);   // its sessions are resumed with the next token
  EXPECT_EQ(api.ask("GET", "/v1/buildings", token).status, 403);
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/points", token, "{}").status, 403);
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/session-tokens", token).status, 403) << "a token must not live for ever";
}

TEST(SessionTokens, EndAfterTheirTimeAndWithTheirKey) {
  RunningApi api;
  const auto token_of = [&](const std::string& key, const std::string& body = "") {
    return api.ask("POST", "/v1/session-tokens", key, body).json()["token"].get<std::string>();
  };
  const std::string brief = token_of(api.admin, R"({"lifetime_s":60})"), full = token_of(api.admin);
  const auto key = api.ask("POST", "/v1/keys", api.admin, R"({"name":"app","scopes":["track"],"expires_in_s":100})").json();
  const std::string outlived = token_of(key["key"]);
  const auto gone = api.ask("POST", "/v1/keys", api.admin, R"({"name":"gone","scopes":["track"]})").json();
  const std::string orphan = token_of(gone["key"]);
  for (const std::string& token : {brief, full, outlived, orphan}) EXPECT_TRUE(api.keys->principal_of(token));
  ASSERT_EQ(api.ask("DELETE", "/v1/keys/" + std::to_string(gone["id"].get<int>()), api.admin).status, 204);
  EXPECT_EQ(api.keys->principal_of(orphan).fault().code, FaultCode::kNotAuthenticated);
  api.clock.shift = std::chrono::seconds(61);
  EXPECT_FALSE(api.keys->principal_of(brief));
  EXPECT_TRUE(api.keys->principal_of(outlived));
  api.clock.shift = std::chrono::seconds(101);
  EXPECT_FALSE(api.keys->principal_of(outlived)) << "the token outlived its key";
  api.clock.shift = std::chrono::seconds(901);
  EXPECT_FALSE(api.keys->principal_of(full));
}

TEST(SessionTokens, NameWhatIsWrongWithARequest) {
  RunningApi api;
  for (const char* body : {R"({"lifetime_s":0})", R"({"lifetime_s":901})", R"({"lifetime_s":"long"})"}) {
    const auto answer = api.ask("POST", "/v1/session-tokens", api.admin, body);
    EXPECT_EQ(answer.status, 422) << body;
    EXPECT_EQ(answer.json().value("field", ""), "lifetime_s") << answer.body;
  }
  EXPECT_EQ(api.ask("POST", "/v1/session-tokens", api.admin, "{").status, 400);
  const std::string one = api.issue({Scope::kTrack}, {1});
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/session-tokens", one).status, 404) << "there is none yet";
  ASSERT_EQ(api.ask("POST", "/v1/buildings", api.admin, R"({"name":"One"})").status, 201);
  EXPECT_EQ(api.ask("POST", "/v1/buildings/2/session-tokens", one).status, 404);
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/session-tokens", one).status, 201);
}

}  // namespace
}  // namespace wayfuse
