#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "sdk/src/recording/import/attitude_trial.hpp"
#include "sdk/src/recording/import/fingerprint_table.hpp"
#include "sdk/src/recording/import/step_trial.hpp"
#include "tests/evaluation/datasets/floor_map.hpp"
#include "tests/evaluation/datasets/recorded_site.hpp"
#include "tests/evaluation/datasets/split.hpp"
#include "tests/evaluation/written_files.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

// The unpacked data sets, or a loud skip.
#define DATA_FOLDER(var, name)                                                                                \
  const char* var##_root = std::getenv("WAYFUSE_DATA");                                                       \
  if (var##_root == nullptr) GTEST_SKIP() << "NO DATA: set WAYFUSE_DATA to the folder of unpacked data sets"; \
  const std::string var = std::string(var##_root) + "/" + (name);                                             \
  if (!fs::exists(var)) GTEST_SKIP() << "NO DATA: " << var << " is missing"

using WalkFileTest = WrittenFiles;
using SiteFolder = WrittenFiles;

TEST(FloorLabels, BecomeOrdinals) {
  const auto values = [](const std::vector<std::string>& labels) {
    std::vector<int> result;
    for (const FloorOrdinal ordinal : floor_ordinals(labels)) result.push_back(ordinal.value);
    return result;
  };
  EXPECT_EQ(values({"B1", "F1", "F2", "F3", "F4"}), (std::vector<int>{-1, 0, 1, 2, 3}));
  EXPECT_EQ(values({"B2", "1F", "2F"}), (std::vector<int>{-2, 0, 1}));
  EXPECT_EQ(values({"L3", "L1"}), (std::vector<int>{2, 0}));
  EXPECT_EQ(values({"G", "L1", "LG1"}), (std::vector<int>{0, 1, -1}));            // ground below the first floor
  EXPECT_EQ(values({"F1", "Mezzanine", "Atrium"}), (std::vector<int>{0, 2, 1}));  // nothing said: above the top
  EXPECT_EQ(values({"F1", "1F"}), (std::vector<int>{0, 1}));                      // never twice the same
}

TEST(Splits, FollowTheHashOfTheTraceId) {
  // Test vectors of the 64-bit FNV-1a function.
  EXPECT_EQ(fnv1a(""), 0xcbf29ce484222325u);
  EXPECT_EQ(fnv1a("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(fnv1a("foobar"), 0x85944171f73967e8u);
  EXPECT_EQ(split_of("foobar"), Split::kTest);  // 0x...e8 is a multiple of 4
  EXPECT_EQ(split_of("a"), Split::kTest);
}

TEST_F(WalkFileTest, ReadsSensorsScansAndSortedWayPoints) {
  const std::string file = write("w1.txt",
                                 "#\tstartTime:1000\r\n#\tBrand:OPPO\tModel:PBCM10\tAndroidName:8\r\n"
                                 "3000\tTYPE_WAYPOINT\t4\t0\r\n"
                                 "1000\tTYPE_WAYPOINT\t0\t0\r\n"
                                 "1020\tTYPE_ACCELEROMETER\t0.1\t0.2\t9.8\t3\r\n"
                                 "1020\tTYPE_GYROSCOPE\t0\t0\t1\t3\r\n"
                                 "1020\tTYPE_ROTATION_VECTOR\t0\t0\t0.6\t3\r\n"
                                 "1030\tTYPE_BEACON\tuuid\t1\t2\r\n"
                                 "2000\tTYPE_WIFI\tmy\tshop\ta8:0c:ca:03:9d:d7\t-49\t2422\t1500\r\n"
                                 "2000\tTYPE_WIFI\t\ta8:0c:ca:03:9d:d8\t-60\t2422\t2600");
  const auto walk = read_walk(file, {100.0, 10.0});
  ASSERT_TRUE(walk) << to_string(walk.fault());
  EXPECT_EQ(walk->id, "w1");
  EXPECT_EQ(walk->device_model, "PBCM10");
  EXPECT_TRUE(walk->complaints.empty());
  ASSERT_EQ(walk->motion.size(), 1u);
  EXPECT_EQ(walk->motion[0].acceleration_mps2->z, 9.8);
  EXPECT_EQ(walk->motion[0].turn_rate_radps->z, 1.0);
  EXPECT_FALSE(walk->motion[0].field_ut);
  EXPECT_DOUBLE_EQ(walk->attitudes.at(0).body_to_enu.w, 0.8);
  ASSERT_EQ(walk->scans.size(), 1u);
  EXPECT_EQ(walk->scans[0].readings.at(0).age, std::chrono::milliseconds(500));
  EXPECT_EQ(walk->scans[0].readings.at(1).age, Duration(0)) << "seen after it arrived: as fresh as can be";
  EXPECT_EQ(walk->way_points.front().point, (BuildingPoint{100.0, 10.0}));
  EXPECT_EQ(walk->truth_at(PhoneTime(std::chrono::milliseconds(1500))), (BuildingPoint{101.0, 10.0}));
  EXPECT_FALSE(walk->truth_at(PhoneTime(std::chrono::milliseconds(999))));
  EXPECT_FALSE(walk->truth_at(PhoneTime(std::chrono::milliseconds(3001))));
}

TEST_F(WalkFileTest, NamesTheLineItLeavesOut) {
  std::string text = "1\tTYPE_WAYPOINT\t0\t0\n";
  for (int i = 2; i < 50; ++i) text += std::to_string(i) + "\tTYPE_ACCELEROMETER\t0\t0\t9.8\t3\n";
  const std::string file = write("w.txt", text + "60\tTYPE_WIFI\tx\tnot-a-mac\t-50\t2412\t50\n");
  const auto walk = read_walk(file, {});
  ASSERT_TRUE(walk);
  ASSERT_EQ(walk->complaints.size(), 1u);
  EXPECT_EQ(walk->complaints[0], file + ":50: not a BSSID: not-a-mac");
}

TEST_F(WalkFileTest, RefusesGarbageAndWalksWithoutTruth) {
  const auto garbage = read_walk(write("g.txt", "hello\nworld\n1\tTYPE_WAYPOINT\t0\t0\n"), {});
  ASSERT_FALSE(garbage);
  EXPECT_NE(garbage.fault().cause.find("g.txt:1"), std::string::npos) << to_string(garbage.fault());
  const auto blind = read_walk(write("b.txt", "1\tTYPE_ACCELEROMETER\t0\t0\t9.8\t3\n"), {});
  ASSERT_FALSE(blind);
  EXPECT_NE(blind.fault().cause.find("TYPE_WAYPOINT"), std::string::npos);
}

// A second of a walk from 1574661000000 on, two way points; rows of its own between them.
std::string walk_of(const std::string& rows) {
  std::string text = "1574661000000\tTYPE_WAYPOINT\t0\t0\n" + rows;
  for (int i = 100; i < 200; ++i) text += "1574661000" + std::to_string(i) + "\tTYPE_ACCELEROMETER\t0\t0\t9.8\t3\n";
  return text + "1574661001000\tTYPE_WAYPOINT\t1\t0\n";
}

TEST_F(WalkFileTest, ARowThatTellsNoLastSeenTimeWasHeardWhenItWasListed) {
  // Without, with an empty one, a full row that ends with a tab, and a network named with tabs.
  const auto walk = read_walk(write("w.txt", walk_of("1574661000500\tTYPE_WIFI\tshop\ta8:0c:ca:03:9d:01\t-49\t2422\n"
                                                     "1574661000500\tTYPE_WIFI\tshop\ta8:0c:ca:03:9d:02\t-50\t2422\t\n"
                                                     "1574661000500\tTYPE_WIFI\tshop\ta8:0c:ca:03:9d:03\t-51\t2422\t1574661000000\t\n"
                                                     "1574661000500\tTYPE_WIFI\tmy\tshop\ta8:0c:ca:03:9d:04\t-52\t2422\n")), {});
  ASSERT_TRUE(walk) << to_string(walk.fault());
  EXPECT_TRUE(walk->complaints.empty()) << walk->complaints.front();
  ASSERT_EQ(walk->scans.size(), 1u);
  std::vector<int> ages_ms, levels;
  for (const ScanReading& reading : walk->scans[0].readings) {
    ages_ms.push_back(static_cast<int>(reading.age.count() / 1000));
    levels.push_back(static_cast<int>(reading.rss_dbm));
  }
  EXPECT_EQ(ages_ms, (std::vector{0, 0, 500, 0}));
  EXPECT_EQ(levels, (std::vector{-49, -50, -51, -52}));
  ASSERT_EQ(walk->notes.size(), 1u);
  EXPECT_NE(walk->notes[0].find("3 of 4 WIFI rows tell no last-seen time"), std::string::npos) << walk->notes[0];
}

TEST_F(WalkFileTest, LastSeenTimesOfAnotherClockAreNoAges) {
  const std::string boot = "1574661000500\tTYPE_WIFI\tshop\ta8:0c:ca:03:9d:01\t-49\t2422\t660000\n";
  const auto walk = read_walk(write("w.txt", walk_of(boot)), {});
  ASSERT_TRUE(walk);
  ASSERT_EQ(walk->scans.at(0).readings.size(), 1u);
  EXPECT_EQ(walk->scans[0].readings[0].age, Duration(0));
  EXPECT_NE(walk->notes.at(0).find("another clock"), std::string::npos);
  const auto mixed = read_walk(write("m.txt", walk_of(boot + "1574661000500\tTYPE_WIFI\tshop\ta8:0c:ca:03:9d:02\t-50\t2422\t1574661000400\n")), {});
  ASSERT_TRUE(mixed);
  ASSERT_EQ(mixed->scans.at(0).readings.size(), 1u) << "an old row beside a fresh one is just old";
  EXPECT_EQ(mixed->scans[0].readings[0].bssid.value, 0xa80cca039d02u);
}

TEST_F(WalkFileTest, LinesOfAWrongClockAndFarWayPointsAreLeftOutByName) {
  const std::string file = write("w.txt", walk_of("0\tTYPE_ACCELEROMETER\t0\t0\t9.8\t3\n9999999999999\tTYPE_GYROSCOPE\t0\t0\t9.8\t3\n"
                                                  "1574661000500\tTYPE_WAYPOINT\t1e9\t0\n"));
  const auto walk = read_walk(file, {});
  ASSERT_TRUE(walk) << to_string(walk.fault());
  EXPECT_EQ(walk->motion.size(), 100u);
  EXPECT_EQ(walk->way_points.size(), 2u);
  ASSERT_EQ(walk->complaints.size(), 3u);
  EXPECT_EQ(walk->complaints[0], file + ":2: its time is an hour or more apart from the rest of the walk");
  EXPECT_NE(walk->complaints[1].find(":3: its time"), std::string::npos);
  EXPECT_NE(walk->complaints[2].find(":4: the way point is farther than 10 km"), std::string::npos);
}

TEST_F(WalkFileTest, AModelThatIsNoNameIsLeftOut) {
  const auto model = [&](const std::string& name) {
    const auto walk = read_walk(write("w.txt", "#\tBrand:x\tModel:" + name + "\tAndroidName:8\n" + walk_of("")), {});
    return walk->device_model + (walk->notes.empty() ? "" : "!");
  };
  EXPECT_EQ(model("PBCM10"), "PBCM10");
  EXPECT_EQ(model("\xE8\x8D\xA3 9"), "\xE8\x8D\xA3 9");
  EXPECT_EQ(model("a\x01z"), "!");
  EXPECT_EQ(model("\xE9t\xE9"), "!") << "Latin-1";
  EXPECT_EQ(model(std::string(257, 'x')), "!");
}

TEST_F(WalkFileTest, AFolderIsNoFile) {
  fs::create_directories(folder_ / "w.txt");
  const auto walk = read_walk((folder_ / "w.txt").string(), {});
  ASSERT_FALSE(walk);
  EXPECT_NE(to_string(walk.fault()).find("w.txt: is a folder"), std::string::npos) << to_string(walk.fault());
}

// A square of 0.001 degrees at the equator (111.3 m), one shop in its lower left quarter, drawn twice.
std::string square_map(double west_deg) {
  const auto ring = [&](double x0, double y0, double x1, double y1) {
    const auto point = [&](double x, double y) { return "[" + std::to_string(west_deg + x) + "," + std::to_string(y) + "]"; };
    return "[[" + point(x0, y0) + "," + point(x1, y0) + "," + point(x1, y1) + "," + point(x0, y1) + "," + point(x0, y0) + "]]";
  };
  const auto feature = [](const std::string& type, const std::string& coordinates) {
    return R"({"type":"Feature","geometry":{"type":")" + type + R"(","coordinates":)" + coordinates + "}}";
  };
  return R"({"type":"FeatureCollection","features":[)" + feature("MultiPolygon", "[" + ring(0, 0, 0.001, 0.001) + "]") + "," +
         feature("Polygon", ring(0, 0, 0.0005, 0.0005)) + "," + feature("Polygon", ring(0, 0, 0.0005, 0.0005)) + "," +
         feature("Point", "[0,0]") + "]}";
}

TEST_F(SiteFolder, FloorsShareOneFrameAndShopsAreNotWalkable) {
  const std::string walk = "1\tTYPE_WAYPOINT\t10\t20\n";
  for (const char* floor : {"F1", "F2", "F3"}) write(std::string(floor) + "/path_data_files/" + floor + "w.txt", walk);
  write("F1/geojson_map.json", square_map(0.0));
  write("F1/floor_info.json", R"({"map_info":{"height":111.3,"width":111.3}})");
  write("F2/geojson_map.json", square_map(0.0001));  // drawn from a corner 11.1 m further east
  write("F2/floor_info.json", R"({"map_info":{"height":111.3,"width":111.3}})");
  const auto site = read_site(folder_.string(), {});
  ASSERT_TRUE(site) << to_string(site.fault());
  ASSERT_EQ(site->floors.size(), 3u);
  ASSERT_TRUE(site->georeference);
  EXPECT_NEAR(site->georeference->origin.longitude_deg, 0.0, 1e-9);
  const Floor& ground = site->floors[0];
  EXPECT_EQ(ground.label, "F1");
  ASSERT_EQ(ground.walkable.size(), 1u);
  EXPECT_FALSE(contains(ground.walkable[0], {20, 20}));
  EXPECT_TRUE(contains(ground.outline, {20, 20}));
  EXPECT_TRUE(contains(ground.walkable[0], {80, 20}));
  EXPECT_NEAR(site->walks[1].floor_origin.x_m, 11.13, 0.01);
  EXPECT_TRUE(contains(site->floors[1].outline, {115, 20}));
  EXPECT_TRUE(site->floors[2].outline.rings.empty());
  ASSERT_EQ(site->complaints.size(), 1u);
  EXPECT_NE(site->complaints[0].find("F3/geojson_map.json: missing"), std::string::npos);
}

TEST_F(SiteFolder, FaultsNameFolderFloorAndFile) {
  EXPECT_EQ(read_site((folder_ / "nowhere").string(), {}).fault().code, FaultCode::kNotFound);
  EXPECT_EQ(read_site(folder_.string(), {}).fault().code, FaultCode::kNotFound);
  write("F1/path_data_files/w.txt", "1\tTYPE_WAYPOINT\t10\t20\n");
  EXPECT_TRUE(read_site(folder_.string(), {}));
  const auto floor = read_site(folder_.string(), {"F9"});
  ASSERT_FALSE(floor);
  EXPECT_NE(floor.fault().cause.find("there are: F1"), std::string::npos);
}

constexpr const char* kSquareInfo = R"({"map_info":{"height":111.3,"width":111.3}})";

TEST_F(SiteFolder, AMapThatCannotBeUsedCostsTheOutlineOnlyAndIsNamed) {
  write("F1/path_data_files/w.txt", "1\tTYPE_WAYPOINT\t10\t20\n");
  const auto note = [&](const std::string& map) {
    const std::string file = write("F1/geojson_map.json", map);
    const auto site = read_site(folder_.string(), {});
    if (!site) return to_string(site.fault());
    EXPECT_TRUE(site->floors.at(0).outline.rings.empty()) << map;
    EXPECT_TRUE(site->complaints.at(0).starts_with(file)) << site->complaints[0];
    EXPECT_NE(site->complaints[0].find("its frame is unknown"), std::string::npos);
    return site->complaints[0];
  };
  const auto first = [](const std::string& geometry) { return R"({"features":[{"geometry":)" + geometry + "}]}"; };
  EXPECT_NE(note("{").find("is not JSON"), std::string::npos);
  EXPECT_NE(note(R"({"features":[]})").find("no polygon"), std::string::npos);
  EXPECT_NE(note(R"({"features":[null]})").find("features[0]: has no geometry"), std::string::npos);
  EXPECT_NE(note(first("null")).find("features[0]: has no geometry"), std::string::npos);
  EXPECT_NE(note(first(R"({"type":null,"coordinates":[]})")).find("has no geometry"), std::string::npos);
  EXPECT_NE(note(first(R"({"type":"Polygon","coordinates":[[[null,1],[2,3],[3,4]]]})")).find("no pair of numbers"), std::string::npos);
  EXPECT_NE(note(first(R"({"type":"Polygon","coordinates":[[[30,120],[31,120],[31,121]]]})")).find("no longitude and latitude"), std::string::npos);
  // Two shops side by side: neither is an outline.
  EXPECT_NE(note(R"({"features":[null,{"geometry":{"type":"Polygon","coordinates":[[[0,0],[0.001,0],[0,0.001]]]}},)"
                 R"({"geometry":{"type":"Polygon","coordinates":[[[1,0],[1.001,0],[1,0.0005]]]}}]})").find("has no geometry"), std::string::npos);
}

TEST_F(SiteFolder, TheOutlineIsFoundHoweverItIsDrawn) {
  write("F1/path_data_files/w.txt", "1\tTYPE_WAYPOINT\t10\t20\n");
  write("F1/floor_info.json", kSquareInfo);
  const std::string ring = "[[0,0],[0.001,0],[0.001,0.001],[0,0.001],[0,0]]";
  const std::string outline = R"({"type":"Polygon","coordinates":[)" + ring + "]}";
  const std::string shop = R"({"geometry":{"type":"Polygon","coordinates":[[[0,0],[0.0005,0],[0.0005,0.0005],[0,0.0005]]]}})";
  const auto feature = [](const std::string& geometry) { return R"({"geometry":)" + geometry + "}"; };
  const auto collection = [](const std::string& features) { return R"({"features":[)" + features + "]}"; };
  const std::string maps[] = {collection(feature(outline) + "," + shop), collection(shop + "," + feature(outline)),
                              collection(feature(R"({"type":"LineString","coordinates":)" + ring + "}") + "," + shop),
                              collection(feature(R"({"type":"GeometryCollection","geometries":[)" + outline + "]}") + "," + shop),
                              collection(feature(R"({"type":"Point","coordinates":[0,0]})") + "," + feature(outline) + "," + shop),
                              collection(feature(outline) + R"(,null,{"geometry":{"type":null}},)" + shop)};
  for (const std::string& map : maps) {
    write("F1/geojson_map.json", map);
    const auto site = read_site(folder_.string(), {});
    ASSERT_TRUE(site) << to_string(site.fault());
    const Floor& floor = site->floors[0];
    EXPECT_TRUE(contains(floor.outline, {100, 100})) << map;
    ASSERT_EQ(floor.walkable.size(), 1u) << map;
    EXPECT_FALSE(contains(floor.walkable[0], {20, 20})) << map;
    EXPECT_TRUE(contains(floor.walkable[0], {80, 20})) << map;
  }
  for (const std::string& alone : {outline, feature(outline)}) {
    write("F1/geojson_map.json", alone);
    EXPECT_TRUE(contains(read_site(folder_.string(), {})->floors[0].outline, {100, 100})) << alone;
  }
}

TEST_F(SiteFolder, TheScaleIsTheWidthsUnlessItCannotBe) {
  write("F1/geojson_map.json", square_map(0.0));  // 111.3 m by its latitude
  const auto walk_to = [&](const std::string& end) { write("F1/path_data_files/w.txt", "1\tTYPE_WAYPOINT\t10\t20\n2\tTYPE_WAYPOINT\t" + end + "\n"); };
  const auto wide_m = [&](const std::string& info) {
    write("F1/floor_info.json", info);
    const Polygon outline = read_site(folder_.string(), {}).value().floors.at(0).outline;
    return outline.rings.empty() ? 0.0 : outline.rings[0].at(1).x_m;
  };
  walk_to("100\t100");
  const auto info = [](const char* width, const char* height) {
    return std::string(R"({"map_info":{"height":)") + height + R"(,"width":)" + width + "}}";
  };
  EXPECT_NEAR(wide_m(info("110", "110")), 110, 0.01);
  EXPECT_NEAR(wide_m(info("\"110.0\"", "\"110.0\"")), 110, 0.01) << "as text";
  EXPECT_NEAR(wide_m(R"({"height":110,"width":110})"), 110, 0.01) << "without map_info";
  EXPECT_NEAR(wide_m(info("150", "80")), 111.3, 0.1) << "other proportions than the outline's";
  EXPECT_NEAR(wide_m(info("15000", "15000")), 111.3, 0.1) << "centimetres: the walk would be lost in it";
  EXPECT_NEAR(wide_m(info("60", "60")), 111.3, 0.1) << "way points outside";
  EXPECT_NEAR(wide_m(info("null", "0")), 111.3, 0.1);
  EXPECT_NEAR(wide_m("[]"), 111.3, 0.1);
  EXPECT_NEAR(wide_m(""), 111.3, 0.1);
  walk_to("140\t140");
  EXPECT_NEAR(wide_m(info("150", "150")), 150, 0.01) << "the way points say so";
  EXPECT_EQ(wide_m(info("60", "60")), 0.0) << "outside at either scale";
}

TEST_F(SiteFolder, AWalkOnTwoFloorsIsReadOnceAndHiddenFilesNever) {
  for (const char* file : {"F1/path_data_files/w.txt", "F2/path_data_files/w.txt", "F2/path_data_files/._w.txt", "F2/path_data_files/x.TXT"}) write(file, "1\tTYPE_WAYPOINT\t10\t20\n");
  const auto site = read_site(folder_.string(), {});
  ASSERT_TRUE(site);
  ASSERT_EQ(site->walks.size(), 2u);
  EXPECT_EQ(site->walks[1].id, "x");
  EXPECT_NE(site->complaints.back().find("F2/path_data_files/w.txt: left out"), std::string::npos) << site->complaints.back();
}

TEST(RealData, SiteOneReadsWhole) {
  DATA_FOLDER(folder, "ilc20/site1");
  const auto site = read_site(folder, {});
  ASSERT_TRUE(site) << to_string(site.fault());
  EXPECT_EQ(site->floors.size(), 5u);
  EXPECT_EQ(site->walks.size(), 521u);
  std::size_t tests = 0;  // fewer than a quarter: the published sample has more, kept apart
  for (const WalkFile& file : site->walks) tests += split_of(file.id) == Split::kTest;
  EXPECT_EQ(tests, 78u);
  // Every 25th walk: way points lie inside the outline, nearly all on walkable ground.
  std::size_t points = 0;
  std::size_t walkable = 0;
  for (std::size_t i = 0; i < site->walks.size(); i += 25) {
    const auto walk = read_walk(site->walks[i].path, site->walks[i].floor_origin);
    ASSERT_TRUE(walk) << to_string(walk.fault());
    EXPECT_TRUE(walk->complaints.empty()) << walk->complaints.front();
    const Floor* floor = site->floor(site->walks[i].floor);
    for (const TruePoint& point : walk->way_points) {
      EXPECT_TRUE(contains(floor->outline, point.point)) << walk->id;
      ++points;
      walkable += contains(floor->walkable.at(0), point.point);
    }
  }
  EXPECT_GT(walkable, points * 95 / 100);
}

TEST(RealData, UjiHasItsPublishedSize) {
  DATA_FOLDER(folder, "ujiindoorloc");
  const auto table = read_uji(folder + "/validationData.csv");
  ASSERT_TRUE(table) << to_string(table.fault());
  EXPECT_EQ(table->scans.size(), 1111u);
  EXPECT_EQ(table->access_points, 520u);
}

TEST(RealData, BroadTrialsHaveTruthAndAMovingPhase) {
  DATA_FOLDER(folder, "broad");
  const auto trials = list_trials(folder);
  ASSERT_EQ(trials.size(), 15u);
  const auto trial = read_broad_trial(trials[0]);
  ASSERT_TRUE(trial) << to_string(trial.fault());
  EXPECT_EQ(trial->samples.size(), trial->truth.size());
  const double rate_hz =
      static_cast<double>(trial->samples.size() - 1) / seconds(trial->samples.back().time - trial->samples.front().time);
  EXPECT_NEAR(rate_hz, 285.714, 0.001);
}

TEST(RealData, TyrexTruthIsOnThePhonesClock) {
  DATA_FOLDER(folder, "tyrex");
  const auto trials = list_trials(folder);
  ASSERT_EQ(trials.size(), 28u);
  const auto trial = read_tyrex_trial(trials[0], TyrexField::kRaw);
  ASSERT_TRUE(trial) << to_string(trial.fault());
  EXPECT_EQ(trial->truth.front().time, PhoneTime(from_seconds(2.4)));  // timeAlignment.txt says -2.4 s
  EXPECT_FALSE(trial->phone.empty());
}

TEST(RealData, OxfordStepsOnlyGrow) {
  DATA_FOLDER(folder, "oxford-steps");
  const auto trials = list_trials(folder);
  ASSERT_EQ(trials.size(), 6u);
  for (const std::string& path : trials) {
    const auto trial = read_oxford_trial(path);
    ASSERT_TRUE(trial) << to_string(trial.fault());
    EXPECT_TRUE(std::is_sorted(trial->true_steps.begin(), trial->true_steps.end())) << trial->name;
    EXPECT_GT(trial->true_steps.back(), 100) << trial->name;
  }
}

}  // namespace
}  // namespace wayfuse
