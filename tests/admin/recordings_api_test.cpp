#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "admin/cli/replay_report.hpp"
#include "tests/admin/running_api.hpp"

namespace wayfuse {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(RecordingsApi, AnOrderIsCheckedFieldByField) {
  RunningApi api;
  const std::string path = "/v1/buildings/1/recording";
  const auto on = api.ask("PUT", path, api.admin, R"({"on_for_s":3600,"bytes":2097152,"tracked":["phone-1"]})");
  ASSERT_EQ(on.status, 200) << on.body;
  EXPECT_EQ(on.json()["on"], true);
  EXPECT_EQ(on.json()["until_us"], 3'600'000'000);
  EXPECT_EQ(on.json()["kept_s"], 86400.0) << "a day where nothing is said";
  EXPECT_EQ(api.recordings.ordered->bytes, 2097152u);
  EXPECT_THAT(api.recordings.ordered->tracked, ElementsAre("phone-1"));
  EXPECT_EQ(api.ask("PUT", path, api.admin, R"({"on_for_s":0})").json()["on"], false);
  for (const auto& [body, field] : {std::pair(R"({})", "on_for_s"), std::pair(R"({"on_for_s":-1})", "on_for_s"),
                                    std::pair(R"({"on_for_s":604801})", "on_for_s"), std::pair(R"({"on_for_s":1,"bytes":1000})", "bytes"),
                                    std::pair(R"({"on_for_s":1,"bytes":268435457})", "bytes"), std::pair(R"({"on_for_s":1,"kept_s":59})", "kept_s"),
                                    std::pair(R"({"on_for_s":1,"tracked":[3]})", "tracked[0]")}) {
    const auto refused = api.ask("PUT", path, api.admin, body);
    EXPECT_EQ(refused.status, 422) << body;
    EXPECT_EQ(refused.json()["field"], field) << refused.body;
  }
}

TEST(RecordingsApi, ListsPages) {
  RunningApi api;
  const auto first = api.ask("GET", "/v1/buildings/1/recordings?most=2", api.admin).json();
  ASSERT_EQ(first["recordings"].size(), 2u);
  EXPECT_EQ(first["recordings"][0]["id"], 7);
  EXPECT_EQ(first["recordings"][0]["seed"], "18446744073709551615") << "a number that JSON's own would round";
  EXPECT_EQ(first["next"], 8);
  const auto last = api.ask("GET", "/v1/buildings/1/recordings?most=2&after=8", api.admin).json();
  EXPECT_EQ(last["recordings"].size(), 1u);
  EXPECT_FALSE(last.contains("next"));
}

TEST(RecordingsApi, FetchesErasesAndReplaysInTheirOwnBuildingOnly) {
  RunningApi api;
  const std::string here = api.issue({Scope::kAdmin}, BuildingId{1}), elsewhere = api.issue({Scope::kAdmin}, BuildingId{2});
  for (const std::string path : {"/v1/recordings/7", "/v1/buildings/1/recordings/7"}) {
    EXPECT_EQ(api.ask("GET", path, api.admin).stream->next(), "{\"type\":\"wayfuse-recording\"}\n");
    EXPECT_EQ(api.ask("POST", path + "/replay", api.admin).status, 200);
    EXPECT_EQ(api.ask("DELETE", path, api.admin).status, 204);
  }
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/recordings/7", here).status, 200);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/2/recordings/7", elsewhere).status, 404);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/recordings/7", elsewhere).status, 404);
  EXPECT_EQ(api.ask("GET", "/v1/recordings/8", api.admin).status, 404);
  EXPECT_EQ(api.ask("POST", "/v1/recordings/8/replay", api.admin).status, 404);
  EXPECT_EQ(api.ask("DELETE", "/v1/recordings/8", api.admin).status, 404);
  EXPECT_EQ(api.ask("DELETE", "/v1/buildings/1/recordings?tracked=phone-1", api.admin).json()["erased"], 1);
  EXPECT_EQ(api.ask("DELETE", "/v1/buildings/1/recordings", api.admin).json()["erased"], 3);
}

TEST(RecordingsApi, EveryReadingOfThemIsInTheAudit) {
  RunningApi api;
  api.ask("GET", "/v1/recordings/7", api.admin);
  api.ask("POST", "/v1/recordings/7/replay", api.admin);
  api.ask("PUT", "/v1/buildings/1/recording", api.admin, R"({"on_for_s":60})");
  const std::string audit = api.ask("GET", "/v1/audit", api.admin).body;
  for (const char* what : {"GET recordings/{recording}\"", "POST recordings/{recording}/replay", "PUT recording\"", "recording 7"}) EXPECT_THAT(audit, HasSubstr(what));
}

TEST(RecordingsApi, ReplaysAsAskedAndAnswersStepByStep) {
  RunningApi api;
  const auto answer = api.ask("POST", "/v1/recordings/7/replay", api.admin, R"({"pipeline":"p1","radio_map_version":3,"after":10,"most":5,"particles":0})");
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(api.recordings.asked->map_version, 3u);
  EXPECT_EQ(api.recordings.asked->after, 10u);
  EXPECT_EQ(api.recordings.asked->most, 5u);
  const auto json = answer.json();
  EXPECT_EQ(json["as_it_was"], false);
  EXPECT_EQ(json["steps"][0]["no_position"], "no fresh scan heard yet");
  EXPECT_EQ(json["steps"][1]["explanation"]["used"][0]["residual_db"], -6.0);
  EXPECT_EQ(json["next"], 2);
  for (const auto& [body, field] : {std::pair(R"({"most":201})", "most"), std::pair(R"({"particles":501})", "particles"),
                                    std::pair(R"({"radio_map_version":-1})", "radio_map_version"), std::pair(R"({"pipeline":3})", "pipeline")}) {
    EXPECT_EQ(api.ask("POST", "/v1/recordings/7/replay", api.admin, body).json()["field"], field);
  }
}

TEST(RecordingsApi, TheCommandLineShowsALineAStep) {
  RunningApi api;
  const std::string shown = cli::replayed(api.ask("POST", "/v1/recordings/7/replay", api.admin).body);
  EXPECT_THAT(shown, HasSubstr("every position the phone was told comes out again, bit for bit"));
  EXPECT_THAT(shown, HasSubstr("no fresh scan heard yet"));
  EXPECT_THAT(shown, HasSubstr("00:00:00:00:00:01 -6"));
  EXPECT_THAT(shown, HasSubstr("go on with --after 2"));
}

}  // namespace
}  // namespace wayfuse
