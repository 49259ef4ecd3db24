#include "admin/cli/survey_import.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/admin/running_api.hpp"
#include "tests/fixtures/scratch_folder.hpp"

namespace wayfuse::cli {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// Files that go into the whole admin API over a real store; building 1 lies on the earth, building 2 is a copy of it.
class SurveyImport : public testing::Test {
 protected:
  SurveyImport() {
    for (const char* name : {"One", "Two"}) {
      const auto made = api.ask("POST", "/v1/buildings", api.admin,
                                json{{"name", name}, {"georeference", {{"origin", {{"latitude_deg", 47.3769}, {"longitude_deg", 8.5417}}}, {"y_axis_azimuth_deg", 12.5}}}}.dump());
      EXPECT_EQ(made.status, 201);
    }
  }
  std::string file(const std::string& name, const std::string& text) {
    const std::string path = (folder.path() / name).string();
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  /// Points every metre, enough for several batches.
  std::string long_file(int points) {
    std::string text = "point,x_m,y_m,floor,bssid,rss_dbm,surveyed_at_us\n";
    for (int i = 0; i < points; ++i) text += std::to_string(i) + "," + std::to_string(i) + ".5,2,0,00:1b:2c:00:00:01,-61,1700000000000000\n";
    return file("long.csv", text);
  }
  ImportReport run(ImportOrder order) {
    const Ask ask = [this](const std::string& method, const std::string& path, const std::string& body) -> Result<Reply> {
      asked.push_back(method + " " + path);
      if (method == "POST" && posts_left-- == 0) return Fault{FaultCode::kTimeout, "server", "the line is cut"};
      const auto answer = api.ask(method, path, api.admin, body);
      return Reply{answer.status, answer.body};
    };
    return import_survey(order, ask, [this](std::size_t done, std::size_t all) { progress.emplace_back(done, all); });
  }
  std::string exported(int building, const std::string& format) {
    return api.ask("GET", "/v1/buildings/" + std::to_string(building) + "/points." + format, api.admin).body;
  }
  long posted() const { return std::ranges::count_if(asked, [](const std::string& each) { return each.starts_with("POST"); }); }

  RunningApi api;
  ScratchFolder folder;
  std::vector<std::string> asked;
  std::vector<std::pair<std::size_t, std::size_t>> progress;
  int posts_left = -1;
};

// Everything an export has to carry: several scans, one that heard nothing, ranges, texts that spreadsheets would run, long numbers.
constexpr const char* kSurvey = R"({"type":"survey","idempotency_key":"by-hand","points":[
  {"place":{"x_m":0.1,"y_m":33.333333333333336,"floor":0},"sigma_m":0.25,"device_model":"=Phone, \"9\"","walk":"'quoted","surveyed_at_us":1700000000000000,
   "scans":[{"time_us":5,"readings":[{"bssid":"00:1b:2c:00:00:01","rss_dbm":-61.123456789,"age_us":300,"frequency_mhz":5180,"range_m":-0.5,"range_sigma_m":0.1},
                                    {"bssid":"00:1b:2c:00:00:02","rss_dbm":-70}]},
            {"time_us":9,"readings":[]}]},
  {"place":{"x_m":-3,"y_m":2,"floor":-1},"surveyed_at_us":1700000000000001,"scans":[{"time_us":-7,"readings":[]}]}]})";

TEST_F(SurveyImport, TakesBackWhatWasExportedInEitherForm) {
  ASSERT_EQ(api.ask("POST", "/v1/buildings/1/points", api.admin, kSurvey).status, 200);
  int copy = 2;
  for (const std::string format : {"csv", "geojson"}) {
    const std::string there = exported(1, format);
    const auto report = run({std::to_string(copy), {file("export." + format, there)}, {}, false, false});
    ASSERT_THAT(report.complaints, IsEmpty()) << report.complaints[0];
    EXPECT_EQ(report.points, 2u);
    EXPECT_EQ(exported(copy, format), there) << format;
    if (format == "csv") {
      ASSERT_EQ(api.ask("POST", "/v1/buildings", api.admin, api.ask("GET", "/v1/buildings/1", api.admin).body).status, 201);
      copy = 3;
    }
  }
}

TEST_F(SurveyImport, UploadsAgainOnlyWhatIsMissing) {
  ImportOrder order{"1", {long_file(700)}, {}, false, false};
  posts_left = 1;
  const auto broken = run(order);
  ASSERT_THAT(broken.complaints, SizeIs(2));
  EXPECT_THAT(broken.complaints[0], HasSubstr("the line is cut"));
  EXPECT_EQ(broken.batches, 3u);
  EXPECT_EQ(broken.uploaded, 1u);
  posts_left = -1;
  asked.clear();
  const auto rest = run(order);
  EXPECT_THAT(rest.complaints, IsEmpty());
  EXPECT_EQ(rest.uploaded, 2u);
  EXPECT_EQ(rest.already_there, 1u);
  EXPECT_EQ(posted(), 2);
  EXPECT_EQ(progress.back(), (std::pair<std::size_t, std::size_t>(3, 3)));
  asked.clear();
  EXPECT_EQ(run(order).already_there, 3u);
  EXPECT_EQ(posted(), 0);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1", api.admin).json()["points"], 700);
}

TEST_F(SurveyImport, OneBadRowKeepsEverythingBackUnlessSaidOtherwise) {
  const std::string good = long_file(3);
  const std::string bad = file("bad.csv", "x_m,y_m,floor,bssid,rss_dbm\n1,2,0,00:1b:2c:00:00:01,-61\n1,2,0,00:1b:2c:00:00:01,loud\n");
  const auto kept = run({"1", {good, bad}, {}, false, false});
  ASSERT_THAT(kept.complaints, SizeIs(1));
  EXPECT_THAT(kept.complaints[0], HasSubstr("1 row does not serve: nothing was uploaded"));
  EXPECT_EQ(posted(), 0);
  const json said = json::parse(to_json({}, kept));
  EXPECT_EQ(said["files"][1]["bad"][0], (json{{"file", bad}, {"row", 3}, {"field", "rss_dbm"}, {"cause", "'loud' is not a number"}}));
  const auto skipped = run({"1", {good, bad}, {}, true, false});
  EXPECT_THAT(skipped.complaints, IsEmpty());
  EXPECT_EQ(skipped.points, 4u);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1", api.admin).json()["points"], 4);
}

TEST_F(SurveyImport, ADryRunReadsAndUploadsNothing) {
  const auto report = run({"1", {long_file(300)}, {}, false, true});
  EXPECT_THAT(report.complaints, IsEmpty());
  EXPECT_EQ(report.points, 300u);
  EXPECT_EQ(report.batches, 2u);
  EXPECT_EQ(posted(), 0);
}

TEST_F(SurveyImport, SaysWhatTheServerSaid) {
  const auto nowhere = run({"77", {long_file(3)}, {}, false, false});
  ASSERT_THAT(nowhere.complaints, SizeIs(1));
  EXPECT_THAT(nowhere.complaints[0], HasSubstr("404"));
  const auto unread = run({"1", {long_file(3), "/nowhere"}, {}, false, false});
  ASSERT_THAT(unread.complaints, SizeIs(1));
  EXPECT_EQ(posted(), 0);
}

}  // namespace
}  // namespace wayfuse::cli
