#include "tests/admin/running_api.hpp"

namespace wayfuse {
namespace {

using nlohmann::json;

const char* const kBuilding = R"({
  "name": "Head office",
  "georeference": {"origin": {"latitude_deg": 47.3769, "longitude_deg": 8.5417}, "y_axis_azimuth_deg": 12.5},
  "magnetic_field": {"declination_deg": 3.1, "dip_deg": 63.5, "norm_ut": 48.2},
  "floors": [{"ordinal": 0, "label": "Ground", "outline": [[[0, 0], [20, 0], [20, 10], [0, 10]]],
              "walkable": [[[[0, 4], [20, 4], [20, 6], [0, 6]]]]}]})";

const char* const kSurvey = R"({"type": "survey", "idempotency_key": "batch-1", "points": [
  {"place": {"x_m": 2.5, "y_m": 5, "floor": 0}, "sigma_m": 0.3, "device_model": "=Phone", "walk": "a", "surveyed_at_us": 1700000000000000,
   "scans": [{"time_us": 1000000, "readings": [{"bssid": "00:1b:2c:00:00:01", "rss_dbm": -61, "age_us": 1200000, "frequency_mhz": 2437},
                                              {"bssid": "00:1b:2c:00:00:02", "rss_dbm": -70.5}]}]},
  {"place": {"x_m": 7.5, "y_m": 5, "floor": 0}, "surveyed_at_us": 1700000001000000,
   "scans": [{"time_us": 2000000, "readings": [{"bssid": "00:1b:2c:00:00:01", "rss_dbm": -55}]}]}]})";

TEST(BuildingsApi, ListsAreReadAPageAtATime) {
  RunningApi api;
  for (int i = 0; i < 4; ++i) {
    ASSERT_EQ(api.ask("POST", "/v1/buildings", api.admin, kBuilding).status, 201);
    ASSERT_EQ(api.ask("POST", "/v1/keys", api.admin, R"({"name":"phone","scopes":["track"]})").status, 201);
  }
  for (const std::string kind : {"buildings", "keys"}) {
    const auto whole = api.ask("GET", "/v1/" + kind, api.admin).json();
    EXPECT_FALSE(whole.contains("next")) << kind;
    ASSERT_GE(whole[kind].size(), 3u) << kind;
    auto read = nlohmann::json::array();
    nlohmann::json page{{"next", 0}};
    while (page.contains("next")) {
      page = api.ask("GET", "/v1/" + kind + "?most=2&after=" + page["next"].dump(), api.admin).json();
      EXPECT_LE(page[kind].size(), 2u) << kind;
      for (const auto& entry : page[kind]) read.push_back(entry);
    }
    EXPECT_EQ(read, whole[kind]) << kind;
    EXPECT_EQ(api.ask("GET", "/v1/" + kind + "?most=0", api.admin).status, 422) << kind;
  }
}

TEST(BuildingsApi, GivesBackTheBuildingItWasGiven) {
  RunningApi api;
  const auto created = api.ask("POST", "/v1/buildings", api.admin, kBuilding);
  ASSERT_EQ(created.status, 201) << created.body;
  const json building = created.json();
  EXPECT_EQ(created.headers.at("location"), "/v1/buildings/" + std::to_string(building["id"].get<int>()));
  const json given = json::parse(kBuilding);
  EXPECT_EQ(building["name"], given["name"]);
  EXPECT_EQ(building["floors"][0]["outline"], given["floors"][0]["outline"]);
  EXPECT_EQ(building["floors"][0]["walkable"], given["floors"][0]["walkable"]);
  EXPECT_NEAR(building["georeference"]["y_axis_azimuth_deg"].get<double>(), 12.5, 1e-9);
  EXPECT_NEAR(building["magnetic_field"]["dip_deg"].get<double>(), 63.5, 1e-9);
  EXPECT_EQ(building["points"], 0);
  EXPECT_EQ(building["radio_map_version"], 7);
  EXPECT_EQ(api.ask("GET", created.headers.at("location"), api.admin).json(), building);
  EXPECT_EQ(api.ask("GET", "/v1/buildings", api.admin).json()["buildings"].size(), 1u);
  EXPECT_EQ(api.server.changed.size(), 1u);
}

TEST(BuildingsApi, ReplacesTheFloorsAndKeepsTheRest) {
  RunningApi api;
  const std::string at = api.ask("POST", "/v1/buildings", api.admin, kBuilding).headers.at("location");
  const auto answer = api.ask("PUT", at + "/floors", api.admin, R"({"floors":[{"ordinal":-1},{"ordinal":0,"label":"G"}]})");
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(answer.json()["floors"].size(), 2u);
  EXPECT_EQ(answer.json()["name"], "Head office");
  const auto renamed = api.ask("PUT", at, api.admin, R"({"name":"Annex","pipeline":"p1"})");
  EXPECT_EQ(renamed.json()["name"], "Annex");
  EXPECT_EQ(renamed.json()["pipeline"], "p1");
}

struct Refused {
  const char* body;
  int status;
  const char* field;
};

TEST(BuildingsApi, NamesTheFieldItRefuses) {
  RunningApi api;
  const Refused cases[] = {
      {"no json", 400, ""},
      {"[]", 422, ""},
      {"{}", 422, "name"},
      {R"({"name":""})", 422, "name"},
      {R"({"name":7})", 422, "name"},
      {"{\"name\":\"a\\u0007b\"}", 422, "name"},
      {R"({"name":"a","pipeline":"magic"})", 422, "pipeline"},
      {R"({"name":"a","georeference":{"origin":{"latitude_deg":91,"longitude_deg":0}}})", 422, "georeference.origin.latitude_deg"},
      {R"({"name":"a","georeference":{}})", 422, "georeference.origin"},
      {R"({"name":"a","magnetic_field":{"norm_ut":1e999}})", 400, ""},
      {R"({"name":"a","magnetic_field":{"norm_ut":-3}})", 422, "magnetic_field.norm_ut"},
      {R"({"name":"a","floors":[{"ordinal":0.5}]})", 422, "floors[0].ordinal"},
      {R"({"name":"a","floors":[{"ordinal":0},{"ordinal":0}]})", 409, "floors[1].ordinal"},
      {R"({"name":"a","floors":[{"ordinal":0,"outline":[[[0,0],[1,1]]]}]})", 422, "floors[0].outline[0]"},
      {R"({"name":"a","floors":[{"ordinal":0,"outline":[[[0,0],[1,1],[1]]]}]})", 422, "floors[0].outline[0][2]"},
      {R"({"name":"a","floors":[{"ordinal":0,"walkable":[[[[0,0],[1,1],[1e7,0]]]]}]})", 422, "floors[0].walkable[0][0][2]"},
  };
  for (const Refused& refused : cases) {
    const auto answer = api.ask("POST", "/v1/buildings", api.admin, refused.body);
    EXPECT_EQ(answer.status, refused.status) << refused.body << answer.body;
    EXPECT_EQ(answer.content_type, "application/problem+json");
    EXPECT_EQ(answer.json().value("field", ""), refused.field) << refused.body << answer.body;
  }
  EXPECT_TRUE(api.ask("GET", "/v1/buildings", api.admin).json()["buildings"].empty());
}

TEST(SurveyApi, StoresABatchOnceAndExportsEveryReading) {
  RunningApi api;
  const std::string at = api.ask("POST", "/v1/buildings", api.admin, kBuilding).headers.at("location");
  for (int i = 0; i < 2; ++i) {
    const auto answer = api.ask("POST", at + "/points", api.admin, kSurvey);
    ASSERT_EQ(answer.status, 200) << answer.body;
    EXPECT_EQ(answer.json()["stored"], 2);
  }
  const json points = api.ask("GET", at + "/points", api.admin).json()["points"];
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1]["place"], json::parse(kSurvey)["points"][1]["place"]);
  EXPECT_EQ(points[0]["scans"][0]["readings"][1]["rss_dbm"], -70.5);
  EXPECT_EQ(points[0]["scans"][0]["readings"][0]["age_us"], 1200000);

  const std::string csv = api.ask("GET", at + "/points.csv", api.admin).body;
  EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 3);
  EXPECT_NE(csv.find("\"'=Phone\""), std::string::npos) << "a formula must not run in a spreadsheet: " << csv;
  const auto geojson = api.ask("GET", at + "/points.geojson", api.admin);
  EXPECT_EQ(geojson.content_type, "application/geo+json");
  EXPECT_NEAR(geojson.json()["features"][0]["geometry"]["coordinates"][1].get<double>(), 47.3769, 1e-3);
  EXPECT_EQ(api.ask("GET", at + "/transmitters", api.admin).json()["transmitters"].size(), 2u);
}

TEST(SurveyApi, PagesThroughPoints) {
  RunningApi api;
  const std::string at = api.ask("POST", "/v1/buildings", api.admin, kBuilding).headers.at("location");
  api.ask("POST", at + "/points", api.admin, kSurvey);
  const json first = api.ask("GET", at + "/points?most=1", api.admin).json();
  ASSERT_EQ(first["points"].size(), 1u);
  const json second = api.ask("GET", at + "/points?after=" + std::to_string(first["next"].get<int>()), api.admin).json();
  EXPECT_EQ(second["points"][0]["place"]["x_m"], 7.5);
  EXPECT_FALSE(second.contains("next"));
  EXPECT_EQ(api.ask("GET", at + "/points?most=0", api.admin).status, 422);
  EXPECT_EQ(api.ask("GET", at + "/points?after=x", api.admin).status, 422);
}

TEST(SurveyApi, RefusesWhatTheProtocolRefusesAndAnotherBodyUnderTheSameKey) {
  RunningApi api;
  const std::string at = api.ask("POST", "/v1/buildings", api.admin, kBuilding).headers.at("location");
  ASSERT_EQ(api.ask("POST", at + "/points", api.admin, kSurvey).status, 200);
  std::string loud = kSurvey;
  loud.replace(loud.find("-61"), 3, "-312");
  const auto refused = api.ask("POST", at + "/points", api.admin, loud);
  EXPECT_EQ(refused.status, 422);
  EXPECT_EQ(refused.json()["field"], "points[0].scans[0].readings[0].rss_dbm");
  std::string other = kSurvey;
  other.replace(other.find("-61"), 3, "-62");
  EXPECT_EQ(api.ask("POST", at + "/points", api.admin, other).status, 409);
  EXPECT_EQ(api.ask("POST", at + "/points", api.admin, R"({"type":"goodbye"})").status, 400);
  EXPECT_EQ(api.ask("POST", "/v1/buildings/99/points", api.admin, kSurvey).status, 404);
}

TEST(SurveyApi, SaysThatGeoJsonNeedsAGeoreference) {
  RunningApi api;
  const std::string at = api.ask("POST", "/v1/buildings", api.admin, R"({"name":"Shed"})").headers.at("location");
  const auto answer = api.ask("GET", at + "/points.geojson", api.admin);
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(answer.json()["field"], "georeference");
}

TEST(OperationsApi, AnswersProbesWithoutAKeyAndTheRestWithOne) {
  RunningApi api;
  EXPECT_EQ(api.ask("GET", "/healthz", "").status, 200);
  EXPECT_EQ(api.ask("GET", "/readyz", "").status, 200);
  api.server.ready = false;
  const auto draining = api.ask("GET", "/readyz", "");
  EXPECT_EQ(draining.status, 503);
  EXPECT_EQ(draining.json()["reasons"][0], "draining");
  EXPECT_FALSE(api.ask("GET", "/v1/version", "").json()["version"].get<std::string>().empty());
  EXPECT_EQ(api.ask("GET", "/metrics", "").status, 401);
  EXPECT_NE(api.ask("GET", "/metrics", api.admin).body.find("wayfuse_sessions 2"), std::string::npos);
  EXPECT_EQ(api.ask("GET", "/v1/sessions", api.admin).json()["sessions"].size(), 2u);
  EXPECT_EQ(api.ask("GET", "/v1/parts", api.admin).json()["parts"][0]["settings"][0]["default"], 4);
  EXPECT_EQ(api.ask("GET", "/v1/pipelines", api.admin).json()["pipelines"][1], "p1");
  EXPECT_EQ(api.ask("GET", "/v1/pipelines/p1", api.admin).status, 200);
  EXPECT_EQ(api.ask("GET", "/v1/pipelines/p9", api.admin).status, 404);
}

TEST(ExplanationApi, HoldsEveryReadingAgainstTheSurveyAndSaysWhatItDoubts) {
  RunningApi api;
  const auto answer = api.ask("GET", "/v1/sessions/phone-1/explain", api.admin);
  ASSERT_EQ(answer.status, 200) << answer.body;
  const json explained = answer.json();
  EXPECT_EQ(explained["used"][0]["residual_db"], -6.0);  // heard at -61, expected at -55
  EXPECT_EQ(explained["used"][0]["age_us"], 300'000);
  EXPECT_EQ(explained["rejected"][0]["why"], "not on the map");
  EXPECT_TRUE(explained["rejected"][0]["expected_dbm"].is_null());
  EXPECT_EQ(explained["floor_votes"][0], json({{"floor", 2}, {"probability", 0.75}}));
  EXPECT_EQ(explained["integrity"], json({{"state", "degraded"}, {"reasons", {"it rains"}}}));
  EXPECT_EQ(explained["particles"], json({{1.5, 2.5, 1.0}}));
  EXPECT_EQ(explained["scan_age_us"], 1'500'000);
}

TEST(ExplanationApi, KnowsASessionInItsOwnBuildingOnlyAndToldTheAuditFirst) {
  RunningApi api;
  const std::string bound = api.issue({Scope::kAdmin}, {1});
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/sessions/phone-1/explain", bound).status, 200);
  const auto elsewhere = api.ask("GET", "/v1/buildings/2/sessions/phone-1/explain", api.admin);
  const auto nowhere = api.ask("GET", "/v1/buildings/2/sessions/phone-9/explain", api.admin);
  EXPECT_EQ(elsewhere.status, 404);
  EXPECT_EQ(elsewhere.body, nowhere.body);
  EXPECT_EQ(api.ask("GET", "/v1/sessions/phone-3/explain", api.admin).status, 409) << "it is there, without a position";
  EXPECT_EQ(api.ask("GET", "/v1/sessions/phone-1/explain", api.issue({Scope::kTrack, Scope::kObserve, Scope::kSurvey}, {})).status, 403);

  const auto lines = api.store->audited({});
  ASSERT_TRUE(lines);
  ASSERT_FALSE(lines->empty());
  EXPECT_TRUE(std::ranges::any_of(*lines, [](const AuditRecord& line) {
    return line.building == BuildingId{1} && line.key_id != 0 && line.action.find("explain") != std::string::npos &&
           line.subject.find("phone-1") != std::string::npos;
  }));
}

TEST(ConsoleRoutes, SendAPageThatMayLoadNothingFromElsewhere) {
  RunningApi api;
  for (const char* path : {"/console/", "/console/console.css", "/console/console.js", "/console/inter.woff2", "/console/licences.txt"}) {
    const auto page = api.ask("GET", path, "");
    EXPECT_EQ(page.status, 200) << path;
    EXPECT_GT(page.body.size(), 300u) << path;
    const std::string policy = page.headers.at("content-security-policy");
    EXPECT_EQ(policy.rfind("default-src 'none'; script-src 'self'; style-src 'self'; ", 0), 0u);
    for (const char* loophole : {"unsafe", "http", "*"}) EXPECT_EQ(policy.find(loophole), std::string::npos) << loophole;
  }
  const std::string page = api.ask("GET", "/console/", "").body;
  EXPECT_EQ(page.find("<style"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos);
}

TEST(ConsoleRoutes, AnswerNotModifiedToABrowserThatHasTheFile) {
  RunningApi api;
  const std::string tag = api.ask("GET", "/console/console.js", "").headers.at("etag");
  EXPECT_NE(tag, api.ask("GET", "/console/console.css", "").headers.at("etag"));
  const auto again = api.ask("GET", "/console/console.js", "", "", {{"if-none-match", tag}});
  EXPECT_EQ(again.status, 304);
  EXPECT_TRUE(again.body.empty());
  EXPECT_EQ(api.ask("GET", "/console/console.js", "", "", {{"if-none-match", "\"old\""}}).status, 200);
}

}  // namespace
}  // namespace wayfuse
