#include <fstream>

#include "admin/plan/features.hpp"
#include "tests/admin/running_api.hpp"

namespace wayfuse {
namespace {

using nlohmann::json;

const char* const kHouse = R"({"name":"House","pipeline":"p1","georeference":{"origin":{"latitude_deg":47.3769,"longitude_deg":8.5417},"y_axis_azimuth_deg":12.5},
  "floors":[{"ordinal":0,"label":"G","outline":[[[0,0],[20,0],[20,10],[0,10]]],"walkable":[[[[0,4],[20,4],[20,6],[0,6]]]],"walls":[[[0,4],[9,4]],[[10,4],[20,4]]]}]})";

std::string survey(const char* key, const char* walk, double x_m) {
  json point{{"place", {{"x_m", x_m}, {"y_m", 5}, {"floor", 0}}}, {"walk", walk}, {"device_model", "Pixel"}, {"surveyed_at_us", 1700000000000000}};
  point["scans"] = json::array({{{"time_us", 1}, {"readings", json::array({{{"bssid", "00:1b:2c:00:00:01"}, {"rss_dbm", -61}}})}}});
  return json{{"type", "survey"}, {"idempotency_key", key}, {"points", json::array({point})}}.dump();
}

class DataApi : public testing::Test {
 protected:
  DataApi() {
    EXPECT_EQ(api.ask("POST", "/v1/buildings", api.admin, kHouse).status, 201);
    EXPECT_EQ(api.ask("POST", "/v1/buildings/1/points", api.admin, survey("b1", "north", 2.5)).status, 200);
    EXPECT_EQ(api.ask("POST", "/v1/buildings/1/points", api.admin, survey("b2", "south", kCanary_m)).status, 200);
    EXPECT_EQ(api.ask("POST", "/v1/buildings/1/zones", api.admin, R"({"name":"Lab","floor":0,"region":[[[0,0],[9,0],[9,9]]]})").status, 201);
  }
  static std::string all_of(const RunningApi::Answer& answer) {
    std::string bytes = answer.body;
    while (auto piece = answer.stream ? answer.stream->next() : std::nullopt) bytes += *piece;
    return bytes;
  }
  // Whether any file of the data folder holds these eight bytes.
  bool on_disk(double value) const {
    const std::string_view canary(reinterpret_cast<const char*>(&value), sizeof value);
    const std::string turned(canary.rbegin(), canary.rend());  // SQLite stores reals with the big end first
    for (const auto& entry : std::filesystem::recursive_directory_iterator(api.folder)) {
      std::ifstream in(entry.path(), std::ios::binary);
      const std::string bytes((std::istreambuf_iterator<char>(in)), {});
      if (bytes.find(canary) != std::string::npos || bytes.find(turned) != std::string::npos) return true;
    }
    return false;
  }
  static constexpr double kCanary_m = 13.370421337;
  RunningApi api;
};

TEST_F(DataApi, RestoresARemovedBuildingFromItsBackup) {
  const auto backup = api.ask("GET", "/v1/buildings/1/backup", api.admin);
  ASSERT_EQ(backup.status, 200) << backup.body;
  const std::string file = all_of(backup);
  EXPECT_EQ(file.substr(0, 15), "SQLite format 3");
  const json before = api.ask("GET", "/v1/buildings/1", api.admin).json();
  EXPECT_EQ(api.ask("POST", "/v1/restore", api.admin, file).status, 409) << "the building is in use";
  EXPECT_EQ(api.ask("DELETE", "/v1/buildings/1", api.admin).status, 204);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1", api.admin).status, 404);
  EXPECT_EQ(api.ask("DELETE", "/v1/buildings/1", api.admin).status, 404);
  const auto restored = api.ask("POST", "/v1/restore", api.admin, file);
  ASSERT_EQ(restored.status, 201) << restored.body;
  EXPECT_EQ(restored.headers.at("location"), "/v1/buildings/1");
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1", api.admin).json(), before);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/zones", api.admin).json()["zones"].size(), 1u);
  const json report = api.ask("GET", "/v1/buildings/1/verification", api.admin).json();
  const json kept = api.ask("GET", "/v1/buildings/1/backups", api.admin).json();
  ASSERT_EQ(kept["backups"].size(), 1u);
  EXPECT_EQ(kept["backups"][0]["bytes"], file.size());
  EXPECT_EQ(kept["backups"][0]["survey_version"], kept["survey_version"]);
  ASSERT_EQ(kept["verifications"].size(), 1u);
  EXPECT_EQ(kept["verifications"][0]["sound"], true);
  EXPECT_TRUE(kept["verifications"][0]["finding"].is_null());
  EXPECT_EQ(api.ask("GET", "/v1/buildings/9/backups", api.admin).status, 404);
  EXPECT_EQ(report["sound"], true);
  EXPECT_EQ(report["points"], 2);
}

TEST_F(DataApi, RefusesABackupThatIsNotSound) {
  std::string file = all_of(api.ask("GET", "/v1/buildings/1/backup", api.admin));
  ASSERT_EQ(api.ask("DELETE", "/v1/buildings/1", api.admin).status, 204);
  EXPECT_EQ(api.ask("POST", "/v1/restore", api.admin, "PK").status, 400);
  const double canary = kCanary_m;
  std::string bytes(reinterpret_cast<const char*>(&canary), sizeof canary);
  std::reverse(bytes.begin(), bytes.end());
  const auto at = file.find(bytes);
  ASSERT_NE(at, std::string::npos);
  file[at + 5] = static_cast<char>(file[at + 5] ^ 1);
  const auto refused = api.ask("POST", "/v1/restore", api.admin, file);
  EXPECT_EQ(refused.status, 500) << refused.body;
  EXPECT_EQ(refused.json()["code"], "store_corrupt");
  for (const auto& entry : std::filesystem::directory_iterator(api.folder)) {
    EXPECT_EQ(entry.path().filename().string().rfind("passing-", 0), std::string::npos) << entry.path();
  }
}

TEST_F(DataApi, NeverGivesARemovedBuildingsNumberAgain) {
  ASSERT_EQ(api.ask("DELETE", "/v1/buildings/1", api.admin).status, 204);
  EXPECT_FALSE(on_disk(kCanary_m)) << "its files are gone";
  EXPECT_EQ(api.ask("POST", "/v1/buildings", api.admin, R"({"name":"Next"})").json()["id"], 2) << "keys and audit speak of 1";
}

TEST_F(DataApi, ErasesPointsFromTheFilesThemselves) {
  ASSERT_TRUE(on_disk(kCanary_m));
  EXPECT_EQ(api.ask("DELETE", "/v1/buildings/1/points", api.admin).json()["field"], "query") << "all of them is not said by saying nothing";
  EXPECT_EQ(api.ask("DELETE", "/v1/buildings/1/points?walk=north&device_model=Nokia", api.admin).json()["erased"], 0);
  const auto erased = api.ask("DELETE", "/v1/buildings/1/points?walk=south", api.admin);
  ASSERT_EQ(erased.status, 200) << erased.body;
  EXPECT_EQ(erased.json()["erased"], 1);
  EXPECT_EQ(erased.json()["log_emptied"], true);
  EXPECT_FALSE(on_disk(kCanary_m)) << "neither in the database nor in its log nor in a copy";
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/points", api.admin).json()["points"].size(), 1u);
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/points", api.admin, survey("b2", "south", kCanary_m)).status, 200);
  EXPECT_FALSE(on_disk(kCanary_m)) << "a retry brings nothing back";
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/verification", api.admin).json()["sound"], true);
}

TEST_F(DataApi, GivesOutEverythingThatWasPutIn) {
  const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x01\x40\0\0\0\xf0", 24);
  ASSERT_EQ(api.ask("PUT", "/v1/buildings/1/floors/0/image", api.admin, png).status, 200);
  ASSERT_EQ(api.ask("POST", "/v1/buildings/1/webhooks", api.admin, R"({"url":"https://example.org/hook"})").status, 201);
  const auto files = unzip(all_of(api.ask("GET", "/v1/buildings/1/export.zip", api.admin)));
  ASSERT_TRUE(files) << to_string(files.fault());
  for (const char* name : {"README.txt", "building.json", "plan.geojson", "zones.json", "points.csv", "webhooks.json", "floor-0.png", "floor-0.json"}) {
    EXPECT_TRUE(files->contains(name)) << name;
  }
  EXPECT_EQ(files->at("floor-0.png"), png);
  EXPECT_EQ(std::ranges::count(files->at("points.csv"), '\n'), 3);
  EXPECT_EQ(files->at("webhooks.json").find("whsec_"), std::string::npos);
  // And it goes in again: the description as it is, the plan by its own importer.
  const auto again = api.ask("POST", "/v1/buildings", api.admin, files->at("building.json"));
  ASSERT_EQ(again.status, 201) << again.body;
  const json original = api.ask("GET", "/v1/buildings/1", api.admin).json();
  EXPECT_EQ(again.json()["floors"], original["floors"]);
  const auto imported = api.ask("PUT", "/v1/buildings/2/plan", api.admin, files->at("plan.geojson"));
  ASSERT_EQ(imported.status, 200) << imported.body;
  const json floor = imported.json()["floors"][0];
  EXPECT_EQ(floor["label"], "G");
  EXPECT_NEAR(floor["outline_m2"].get<double>(), 200, 0.1);
  EXPECT_NEAR(floor["walkable_m2"].get<double>(), 40, 0.1);
  EXPECT_EQ(floor["walls"], 2);
}

TEST_F(DataApi, ListsTheAuditPageByPage) {
  const json all = api.ask("GET", "/v1/audit", api.admin).json()["audit"];
  ASSERT_GE(all.size(), 2u);
  EXPECT_EQ(all[0]["action"], "POST buildings");
  EXPECT_EQ(all[1]["action"], "POST zones");
  EXPECT_EQ(all[1]["building"], 1);
  const json first = api.ask("GET", "/v1/audit?most=1", api.admin).json();
  EXPECT_EQ(first["audit"].size(), 1u);
  EXPECT_EQ(api.ask("GET", "/v1/audit?most=1&after=" + first["next"].dump(), api.admin).json()["audit"][0], all[1]);
  EXPECT_EQ(api.ask("GET", "/v1/audit?building=9", api.admin).json()["audit"].size(), 0u);
}

TEST_F(DataApi, StoresAPlanOnlyWhenItIsSoundAndNotADryRun) {
  const std::string square = R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"kind":"outline"},"geometry":{"type":"Polygon",
    "coordinates":[[[0,0],[30,0],[30,10],[0,10],[0,0]]]}},{"type":"Feature","properties":{"kind":"room","name":"Shop"},"geometry":{"type":"Polygon",
    "coordinates":[[[0,0],[10,0],[10,10],[0,10],[0,0]]]}}]})";
  const std::string at = "/v1/buildings/1/plan?coordinates=local&floor=1";
  const auto dry = api.ask("PUT", at + "&dry_run=1", api.admin, square);
  ASSERT_EQ(dry.status, 200) << dry.body;
  EXPECT_EQ(dry.json()["stored"], false);
  EXPECT_EQ(dry.json()["zones"][0]["name"], "Shop");
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1", api.admin).json()["floors"].size(), 1u);
  const auto stored = api.ask("PUT", at + "&label=First&zones=1", api.admin, square);
  ASSERT_EQ(stored.status, 200) << stored.body;
  const json building = api.ask("GET", "/v1/buildings/1", api.admin).json();
  ASSERT_EQ(building["floors"].size(), 2u) << "the ground floor stays";
  EXPECT_EQ(building["floors"][1]["label"], "First");
  EXPECT_EQ(building["floors"][1]["walkable"].size(), 1u);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/zones?floor=1", api.admin).json()["zones"].size(), 1u);
  std::string open = square;
  open.replace(open.find(",[0,0]]]"), 6, "");
  const auto refused = api.ask("PUT", at, api.admin, open);
  EXPECT_EQ(refused.status, 422);
  EXPECT_EQ(refused.json()["checks"][0]["code"], "open_ring") << refused.body;
  EXPECT_EQ(api.ask("PUT", "/v1/buildings/1/plan?coordinates=furlongs", api.admin, square).json()["field"], "coordinates");
}

TEST_F(DataApi, HoldsAPlanAgainstTheSurvey) {
  const std::string elsewhere = R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"kind":"outline","floor":0},"geometry":{"type":"Polygon",
    "coordinates":[[[100,0],[130,0],[130,10],[100,10],[100,0]]]}}]})";
  const json report = api.ask("PUT", "/v1/buildings/1/plan?coordinates=local&dry_run=1", api.admin, elsewhere).json();
  EXPECT_NE(report.dump().find("0 of 2 reference points lie inside the outline"), std::string::npos) << report.dump();
}

TEST_F(DataApi, LaysTheBuildingOnTheEarth) {
  const std::string three = R"({"control_points":[{"x_m":0,"y_m":0,"latitude_deg":47.0,"longitude_deg":8.0},
    {"x_m":100,"y_m":0,"latitude_deg":47.0,"longitude_deg":8.0013145},{"x_m":0,"y_m":100,"latitude_deg":47.00089954,"longitude_deg":8.0}]})";
  const auto fit = api.ask("PUT", "/v1/buildings/1/georeference", api.admin, three);
  ASSERT_EQ(fit.status, 200) << fit.body;
  EXPECT_LT(fit.json()["rms_m"].get<double>(), 0.1) << fit.body;
  EXPECT_EQ(fit.json()["stored"], true);
  const json building = api.ask("GET", "/v1/buildings/1", api.admin).json();
  EXPECT_NEAR(building["georeference"]["y_axis_azimuth_deg"].get<double>(), 0, 0.05);
  std::string feet = three;
  feet.replace(feet.find("\"x_m\":100"), 9, "\"x_m\":328");
  feet.replace(feet.find("\"y_m\":100"), 9, "\"y_m\":328");
  const auto refused = api.ask("PUT", "/v1/buildings/1/georeference", api.admin, feet);
  EXPECT_EQ(refused.status, 422);
  EXPECT_EQ(refused.json()["checks"][0]["code"], "scale");
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1", api.admin).json()["georeference"], building["georeference"]);
}

TEST_F(DataApi, KeepsAFloorsPictureAndWhereItLies) {
  const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x01\x40\0\0\0\xf0", 24);
  const std::string at = "/v1/buildings/1/floors/0/image";
  EXPECT_EQ(api.ask("GET", at, api.admin).status, 404);
  const auto over_outline = api.ask("PUT", at, api.admin, png);
  ASSERT_EQ(over_outline.status, 200) << over_outline.body;
  EXPECT_EQ(over_outline.json()["width_m"], 20);
  const auto placed = api.ask("PUT", at + "?width_m=32&origin_x_m=-1&azimuth_deg=90", api.admin, png);
  EXPECT_EQ(placed.json()["height_m"], 24) << "as high as its pixels say";
  EXPECT_EQ(api.ask("GET", at + "/placement", api.admin).json(), placed.json());
  const auto image = api.ask("GET", at, api.admin);
  EXPECT_EQ(image.body, png);
  EXPECT_EQ(image.content_type, "image/png");
  EXPECT_EQ(api.ask("GET", at, api.admin, "", {{"if-none-match", image.headers.at("etag")}}).status, 304);
  EXPECT_EQ(api.ask("PUT", "/v1/buildings/1/floors/5/image", api.admin, png).status, 404);
  EXPECT_EQ(api.ask("PUT", at, api.admin, "GIF89a").status, 400);
  EXPECT_EQ(api.ask("PUT", at + "?origin_x_m=3", api.admin, png).json()["field"], "width_m");
  EXPECT_EQ(api.ask("DELETE", at, api.admin).status, 204);
  EXPECT_EQ(api.ask("GET", at, api.admin).status, 404);
}

TEST_F(DataApi, ShowsAWebhooksSecretOnce) {
  const auto made = api.ask("POST", "/v1/buildings/1/webhooks", api.admin, R"({"url":"https://example.org/hook","zones":[1]})");
  ASSERT_EQ(made.status, 201) << made.body;
  EXPECT_EQ(made.json()["secret"].get<std::string>().rfind("whsec_", 0), 0u);
  const auto shown = api.ask("GET", "/v1/buildings/1/webhooks/1", api.admin);
  EXPECT_FALSE(shown.json().contains("secret"));
  EXPECT_EQ(shown.json()["zones"], json::array({1}));
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/webhooks", api.admin).json()["webhooks"].size(), 1u);
  const auto off = api.ask("PUT", "/v1/buildings/1/webhooks/1", api.admin, R"({"url":"https://example.org/b","enabled":false})", {{"if-match", shown.headers.at("etag")}});
  ASSERT_EQ(off.status, 200) << off.body;
  EXPECT_EQ(off.json()["enabled"], false);
  EXPECT_EQ(api.ask("PUT", "/v1/buildings/1/webhooks/1", api.admin, R"({"url":"https://example.org/c"})", {{"if-match", shown.headers.at("etag")}}).status, 412);
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/webhooks", api.admin, R"({"url":"https://169.254.169.254/"})").json()["field"], "url");
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/webhooks", api.admin, R"({"url":"http://example.org/"})").json()["field"], "url");
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/webhooks/1/dead-letters", api.admin).json()["dead_letters"], json::array());
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/webhooks/1/dead-letters/retry", api.admin).json()["retried"], 0);
  EXPECT_EQ(api.ask("POST", "/v1/buildings/1/webhooks/1/dead-letters/retry?event=77-1", api.admin).status, 404);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/webhooks/1/deliveries", api.admin).json()["deliveries"], json::array());
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/webhooks/9/deliveries", api.admin).status, 404);
  EXPECT_EQ(api.ask("DELETE", "/v1/buildings/1/webhooks/1", api.admin).status, 204);
  EXPECT_EQ(api.ask("GET", "/v1/buildings/1/webhooks/1", api.admin).status, 404);
}

}  // namespace
}  // namespace wayfuse
