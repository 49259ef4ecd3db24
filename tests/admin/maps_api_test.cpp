#include "tests/admin/running_api.hpp"

namespace wayfuse {
namespace {

using nlohmann::json;

class MapsApi : public testing::Test {
 protected:
  MapsApi() : at(api.ask("POST", "/v1/buildings", api.admin, R"({"name":"Hall"})").headers.at("location")) {}
  void on_database(const std::function<void(BuildingDatabase&)>& task) {
    api.store->with_building({1}, [&](Result<BuildingDatabase*> database) { task(*database.value()); });
  }
  std::uint64_t stage(const std::string& content) {
    std::uint64_t version = 0;
    on_database([&](BuildingDatabase& database) { version = database.stage_map({0, R"({"points":7})", {}, content})->version; });
    return version;
  }
  RunningApi api;
  std::string at;
};

TEST_F(MapsApi, AVersionSaysHowLoudThePhonesHearThatSurveyedIt) {
  on_database([](BuildingDatabase& database) {
    const std::string recipe = R"({"points":9,"devices":[{"model":"Pixel 8","points":6,"standing":"reference","offset_db":0.0,"places":0,)"
                               R"("transmitters":0},{"model":"Nord","points":3,"standing":"learnt","offset_db":5.8,"places":12,"transmitters":31}]})";
    EXPECT_TRUE(database.stage_map({0, recipe, {}, "content"}));
  });
  const json map = api.ask("GET", at + "/maps/1", api.admin).json();
  ASSERT_EQ(map["devices"].size(), 2u);
  EXPECT_EQ(map["devices"][1]["model"], "Nord");
  EXPECT_EQ(map["devices"][1]["offset_db"], 5.8);
  stage("built before models were told apart");
  EXPECT_TRUE(api.ask("GET", at + "/maps/2", api.admin).json()["devices"].empty());
}

TEST_F(MapsApi, ListsVersionsAPageAtATimeWithTheirQuality) {
  const std::uint64_t one = stage("one"), two = stage("two");
  on_database([&](BuildingDatabase& database) {
    Publication publication;
    publication.version = one;
    publication.reason = "first";
    EXPECT_TRUE(database.promote(publication, std::nullopt));
  });
  const auto added = api.ask("POST", at + "/quality-walks?name=round", api.admin, "a recording");
  ASSERT_EQ(added.status, 201) << added.body;
  EXPECT_EQ(added.json()["device_model"], "Model");
  EXPECT_EQ(api.ask("POST", at + "/quality-walks?name=round", api.admin, "another").status, 409);
  EXPECT_EQ(api.ask("POST", at + "/quality-walks", api.admin, "").json()["field"], "line 1");
  on_database([&](BuildingDatabase& database) {
    MapQuality quality;
    quality.version = one;
    quality.walk_id = 1;
    quality.asked = quality.instants = 10;
    quality.mean_m = 3.0;
    quality.error_quantiles_m = std::vector<float>(101, 3.0f);
    EXPECT_TRUE(database.note_quality(quality));
  });
  const json first = api.ask("GET", at + "/maps?most=1", api.admin).json();
  ASSERT_EQ(first["items"].size(), 1u);
  EXPECT_EQ(first["items"][0]["live"], true);
  EXPECT_EQ(first["items"][0]["points"], 7);
  EXPECT_EQ(first["items"][0]["sha256"].get<std::string>().size(), 64u);
  EXPECT_EQ(first["items"][0]["quality"]["median_m"], 3.0);
  EXPECT_EQ(first["items"][0]["quality"]["error_quantiles_m"].size(), 101u);
  const json second = api.ask("GET", at + "/maps?after=" + std::to_string(first["next"].get<int>()), api.admin).json();
  EXPECT_EQ(second["items"][0]["version"], two);
  EXPECT_TRUE(second["items"][0]["quality"].is_null());
  EXPECT_FALSE(second.contains("next"));
  EXPECT_EQ(api.ask("GET", at + "/maps/99", api.admin).status, 404);
  EXPECT_EQ(api.ask("GET", at + "/maps?most=0", api.admin).status, 422);
  EXPECT_EQ(api.ask("GET", at + "/maps/publications", api.admin).json()["items"][0]["reason"], "first");
  EXPECT_EQ(api.ask("DELETE", at + "/quality-walks/1", api.admin).status, 204);
  EXPECT_TRUE(api.ask("GET", at + "/quality-walks", api.admin).json()["items"].empty());
}

TEST_F(MapsApi, RefusesAWorseMapWithTheComparisonAndTakesAnOverrideWithAReason) {
  const auto refused = api.ask("POST", at + "/maps/2/promotion", api.admin, R"({"expected_live":1})");
  EXPECT_EQ(refused.status, 409);
  EXPECT_EQ(refused.json()["comparison"]["verdict"], "worse");
  EXPECT_EQ(api.maps.promoted.expected_live, 1u);
  EXPECT_EQ(api.ask("POST", at + "/maps/2/promotion", api.admin, R"({"override":true})").json()["field"], "reason");
  EXPECT_EQ(api.ask("POST", at + "/maps/2/promotion", api.admin, R"({"override":1})").json()["field"], "override");
  EXPECT_EQ(api.ask("POST", at + "/maps/2/promotion", api.admin, R"({"expected_live":"x"})").json()["field"], "expected_live");
  const auto forced = api.ask("POST", at + "/maps/2/promotion", api.admin, R"({"override":true,"reason":"new wing"})");
  EXPECT_EQ(forced.status, 201) << forced.body;
  EXPECT_EQ(forced.json()["reason"], "new wing");
  EXPECT_NE(api.maps.promoted.by_key, 0u) << "who did it is written down";
  EXPECT_EQ(api.ask("POST", at + "/maps/rollback", api.admin).json()["act"], "rolled_back");
  EXPECT_EQ(api.ask("GET", at + "/maps/2/comparison?pipeline=p1", api.admin).json()["pipeline"], "p1");
}

TEST_F(MapsApi, ShowsAccuracyPlanAndAccessPoints) {
  const json accuracy = api.ask("GET", at + "/accuracy?floor=-1", api.admin).json();
  EXPECT_EQ(accuracy["floor"], -1);
  EXPECT_EQ(accuracy["expected_m"], json::parse("[2.5,null]"));
  EXPECT_EQ(api.ask("GET", at + "/accuracy", api.admin).json()["field"], "floor");
  EXPECT_EQ(api.ask("GET", at + "/survey-plan?floor=x", api.admin).json()["field"], "floor");
  EXPECT_EQ(api.ask("GET", at + "/survey-plan?floor=0", api.admin).json()["walks"][0]["path"][1], json::parse("[40.0,0.0]"));
  const json point = api.ask("GET", at + "/access-points", api.admin).json()["items"][0];
  EXPECT_EQ(point["state"], "moved");
  EXPECT_EQ(point["quarantined"], true);
  EXPECT_EQ(point["distance_m"], 61.0);
  const auto trusted = api.ask("PUT", at + "/access-points/00:1b:2c:00:00:01", api.admin, R"({"trust":"always"})");
  EXPECT_EQ(trusted.json()["quarantined"], false);
  EXPECT_EQ(api.ask("PUT", at + "/access-points/00:1b:2c:00:00:01", api.admin, R"({"trust":"maybe"})").json()["field"], "trust");
  EXPECT_EQ(api.ask("PUT", at + "/access-points/nobody", api.admin, R"({"trust":"auto"})").status, 404);
}

TEST_F(MapsApi, ABuildingsMapsComeByThemselvesUnlessItSaysReviewed) {
  EXPECT_EQ(api.ask("GET", at, api.admin).json()["publication"], "automatic");
  EXPECT_EQ(api.ask("PUT", at, api.admin, R"({"name":"Hall","publication":"reviewed"})").json()["publication"], "reviewed");
  EXPECT_EQ(api.ask("PUT", at, api.admin, R"({"name":"Hall","publication":"never"})").json()["field"], "publication");
}

}  // namespace
}  // namespace wayfuse
