#include "admin/cli/survey_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include "tests/fixtures/scratch_folder.hpp"

namespace wayfuse::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class SurveyFiles : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) {
    const std::string path = (folder_.path() / name).string();
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  // Each as `row: field: cause`, without the file's name.
  static std::vector<std::string> rows(const SurveyFile& file) {
    std::vector<std::string> said;
    for (const RowFault& row : file.bad) said.push_back(to_string(row).substr(row.file.size() + 1));
    return said;
  }
  ScratchFolder folder_;
};

constexpr const char* kHeader = "point,x_m,y_m,floor,sigma_m,device_model,walk,surveyed_at_us,scan,scan_time_us,bssid,rss_dbm,age_us,frequency_mhz\r\n";

TEST_F(SurveyFiles, CsvRowsBecomePointsWithTheirScans) {
  const auto read = read_survey_file(file("a.csv", std::string(kHeader) +
      "1,1.5,2,0,0.3,\"'=Phone \"\"9\"\"\",hall,1700000000000000,0,50,00:1b:2c:00:00:01,-61.5,300,5180\r\n"
      "1,1.5,2,0,0.3,\"'=Phone \"\"9\"\"\",hall,1700000000000000,0,50,00:1b:2c:00:00:02,-70,0,\r\n"
      "1,1.5,2,0,0.3,\"'=Phone \"\"9\"\"\",hall,1700000000000000,1,90,,,,\r\n"
      "2,3,2,-1,0,,,1700000000000001,0,95,00:1b:2c:00:00:01,-61,0,0\r\n"), {});
  ASSERT_TRUE(read) << to_string(read.fault());
  EXPECT_EQ(read->format, "csv");
  EXPECT_EQ(read->rows, 4u);
  EXPECT_THAT(rows(*read), IsEmpty());
  ASSERT_THAT(read->points, SizeIs(2));
  const ReferencePoint& point = read->points[0];
  EXPECT_EQ(point.device_model, "=Phone \"9\"");
  EXPECT_EQ(point.walk, "hall");
  ASSERT_THAT(point.scans, SizeIs(2));
  EXPECT_EQ(point.scans[0], (RssScan{PhoneTime(Duration(50)), {{{0x001b2c000001}, -61.5, Duration(300), 5180, {}, {}}, {{0x001b2c000002}, -70, {}, 0, {}, {}}}}));
  EXPECT_EQ(point.scans[1], (RssScan{PhoneTime(Duration(90)), {}})) << "a scan that heard nothing";
  EXPECT_EQ(read->points[1].place, (Place{{3, 2}, {-1}}));
}

TEST_F(SurveyFiles, CsvFaultsNameRowFieldAndCause) {
  const auto read = read_survey_file(file("a.csv",
      "x_m,y_m,floor,bssid,rss_dbm,scan_time_us\n"
      "1,2,0,00:1b:2c:00:00:01,-61,5\n"
      "one,2,0,00:1b:2c:00:00:01,-61,5\n"
      "1,2,0.5,00:1b:2c:00:00:01,-61,5\n"
      "1,2,0,somebody,-61,5\n"
      "1,2,0,00:1b:2c:00:00:02,-312,5\n"
      "\n"
      "1,2,0,00:1b:2c:00:00:02\n"
      "1,2,0,\"00:1b,-61,5\n"
      "1,2,0,00:1b:2c:00:00:03,-62,5\n"), {});
  ASSERT_TRUE(read) << to_string(read.fault());
  EXPECT_THAT(rows(*read), ElementsAre("3: x_m: 'one' is not a number", "4: floor: '0.5' is not a whole number", "5: bssid: 'somebody' is no BSSID",
                                       "6: rss_dbm: -312 is outside -120..0", "8: 6 fields expected, 4 found", "9: a quote does not end"));
  EXPECT_EQ(read->rows, 8u);
  ASSERT_THAT(read->points, SizeIs(1)) << "the good rows of one place and time are one point";
  EXPECT_THAT(read->points[0].scans[0].readings, SizeIs(2));
}

TEST_F(SurveyFiles, CsvRowsOfOnePointMustAgree) {
  const auto read = read_survey_file(file("a.csv",
      "point,x_m,y_m,floor,bssid,rss_dbm,scan,scan_time_us\n"
      "7,1,2,0,00:1b:2c:00:00:01,-61,0,5\n"
      "7,1,2,1,00:1b:2c:00:00:02,-61,0,5\n"
      "7,1,2,0,00:1b:2c:00:00:03,-61,0,6\n"), {});
  ASSERT_TRUE(read);
  EXPECT_THAT(rows(*read), ElementsAre("3: floor: differs from row 2 of the same point", "4: scan_time_us: differs from row 2 of the same scan"));
}

TEST_F(SurveyFiles, CsvWithoutWhatItNeedsIsRefusedAsAWhole) {
  const auto missing = read_survey_file(file("a.csv", "x_m,y_m,bssid,rss_dbm\n"), {});
  ASSERT_FALSE(missing);
  EXPECT_THAT(to_string(missing.fault()), HasSubstr("a.csv:1: column floor is missing"));
  const auto twice = read_survey_file(file("b.csv", "x_m,y_m,floor,floor,bssid,rss_dbm\n"), {});
  ASSERT_FALSE(twice);
  EXPECT_THAT(to_string(twice.fault()), HasSubstr("column floor stands twice"));
}

constexpr const char* kFeature = R"({"type":"Feature","properties":{"floor":1,"x_m":1.5,"y_m":2,"surveyed_at_us":1700000000000000,"scans":[{"time_us":5,"readings":[{"bssid":"00:1b:2c:00:00:01","rss_dbm":-61}]},{"time_us":9,"readings":[]}]}})";

TEST_F(SurveyFiles, GeoJsonFeaturesBecomePoints) {
  const auto read = read_survey_file(file("a.geojson", R"({"type":"FeatureCollection","features":[)" + std::string(kFeature) + "]}"), {});
  ASSERT_TRUE(read) << to_string(read.fault());
  ASSERT_THAT(read->points, SizeIs(1));
  EXPECT_EQ(read->points[0].place, (Place{{1.5, 2}, {1}}));
  EXPECT_THAT(read->points[0].scans, SizeIs(2));
}

TEST_F(SurveyFiles, GeoJsonFaultsNameTheLineOfTheirFeature) {
  const auto read = read_survey_file(file("a.geojson",
      "{\"type\":\"FeatureCollection\",\n \"name\": \"{[\\\"\",\n\"features\":[\n" + std::string(kFeature) + ",\n"
      R"({"type":"Feature","properties":{"floor":1,"x_m":1,"y_m":2,"scans":[{"time_us":5,"readings":[]},{"time_us":5,"readings":[{"bssid":"00:1b:2c:00:00:01","rss_dbm":-312}]}]}},)" "\n"
      R"({"type":"Feature","geometry":{"type":"Point","coordinates":[8.5,47.3]},"properties":{"floor":1,"scans":[]}},)" "\n"
      R"({"type":"Feature","properties":{"x_m":1,"y_m":2,"scans":[]}}]})"), {});
  ASSERT_TRUE(read) << to_string(read.fault());
  EXPECT_THAT(rows(*read), ElementsAre(HasSubstr("5: features[1].properties.scans[1].readings[0].rss_dbm: -312"),
                                       HasSubstr("6: features[2].geometry.coordinates: the building has no georeference"),
                                       HasSubstr("7: features[3].properties.floor: is required")));
  const auto broken = read_survey_file(file("b.geojson", "{\"type\":\n\"FeatureCollection\",,}"), {});
  ASSERT_FALSE(broken);
  EXPECT_THAT(to_string(broken.fault()), HasSubstr("line 2"));
  EXPECT_FALSE(read_survey_file(file("c.geojson", R"({"type":"FeatureCollection","features":[],"id":1e999})"), {})) << "a number beyond a double";
}

TEST_F(SurveyFiles, GeoJsonIsLaidDownByTheBuildingsGeoreference) {
  SurveyFileSettings settings;
  settings.georeference = Georeference{{47.3769, 8.5417}, 0.3};
  const GeoPoint geo = settings.georeference->to_geo({12, 34});
  char feature[300];
  std::snprintf(feature, sizeof feature,
                R"({"type":"FeatureCollection","features":[{"type":"Feature","geometry":{"type":"Point","coordinates":[%.12f,%.12f]},"properties":{"floor":0,"scans":[{"time_us":5,"readings":[]}]}}]})",
                geo.longitude_deg, geo.latitude_deg);
  const auto read = read_survey_file(file("a.geojson", feature), settings);
  ASSERT_TRUE(read) << to_string(read.fault());
  ASSERT_THAT(read->points, SizeIs(1)) << rows(*read)[0];
  EXPECT_NEAR(read->points[0].place.point.x_m, 12, 1e-4);
  EXPECT_NEAR(read->points[0].place.point.y_m, 34, 1e-4);
}

// The published rows' own place: the Jaume I university in Castellon, 39.99 N 0.07 W.
constexpr const char* kUji =
    "WAP001,WAP002,WAP003,LONGITUDE,LATITUDE,FLOOR,BUILDINGID,SPACEID,RELATIVEPOSITION,USERID,PHONEID,TIMESTAMP\n"
    "100,-50,-70,-7541.26,4864921.0,2,1,106,2,2,23,1371713733\n"
    "100,100,-70,-7541.26,4864930.0,2,1,106,2,2,23,1371713734\n"
    "100,-500,-70,-7541.26,4864921.0,2,1,106,2,2,23,1371713735\n";

TEST_F(SurveyFiles, UjiIsLaidDownFromWebMercator) {
  SurveyFileSettings settings;
  EXPECT_THAT(to_string(read_survey_file(file("u.csv", kUji), settings).fault()), HasSubstr("no georeference"));
  settings.georeference = Georeference{{39.9929, -0.0677}, 0.0};
  const auto read = read_survey_file(file("u.csv", kUji), settings);
  ASSERT_TRUE(read) << to_string(read.fault());
  EXPECT_EQ(read->format, "uji");
  EXPECT_THAT(rows(*read), ElementsAre("4: WAP002: -500 is outside -120..0 dBm and not 100"));
  ASSERT_THAT(read->points, SizeIs(2));
  EXPECT_EQ(to_string(read->points[0].scans[0].readings[0].bssid), "02:00:00:00:00:02");
  EXPECT_EQ(read->points[0].place.floor.value, 2);
  EXPECT_EQ(read->points[0].device_model, "UJI phone 23");
  // 9 Mercator units to the north are 9 cos(39.99 deg) = 6.895 m.
  EXPECT_NEAR(read->points[1].place.point.y_m - read->points[0].place.point.y_m, 6.895, 0.02);
}

TEST_F(SurveyFiles, UjiOfSeveralBuildingsAsksWhichIsMeant) {
  SurveyFileSettings settings;
  settings.georeference = Georeference{{39.9929, -0.0677}, 0.0};
  std::string text = kUji;
  text += "100,-50,-70,-7541.26,4864921.0,2,0,106,2,2,23,1371713733\n";
  const auto read = read_survey_file(file("u.csv", text), settings);
  ASSERT_FALSE(read);
  EXPECT_THAT(to_string(read.fault()), HasSubstr("BUILDINGID 0, 1"));
  settings.source_building = 0;
  EXPECT_THAT(read_survey_file(file("u.csv", text), settings)->points, SizeIs(1));
}

// A walk of 10 m in 10 s; each scan's only row was heard when it arrived.
std::string trace(const std::string& more = "") {
  std::string text = "#\tstartTime:1560913000000\n#\tModel:Phone\tFloorName:F2\n1560913000000\tTYPE_WAYPOINT\t0\t0\n1560913010000\tTYPE_WAYPOINT\t10\t0\n";
  for (int i = 0; i < 30; ++i) text += "15609130000" + std::to_string(10 + i) + "\tTYPE_ACCELEROMETER\t0\t0\t9.8\t2\n";
  for (const int second : {2, 6}) {
    const std::string time = "156091300" + std::to_string(second) + "000";
    text += time + "\tTYPE_WIFI\tname\t00:1b:2c:00:00:0" + std::to_string(second) + "\t-60\t5180\t" + time + "\n";
  }
  return text + more;
}

TEST_F(SurveyFiles, WalksArePlacedBetweenTheirMarks) {
  const auto read = read_survey_file(file("walk-1.txt", trace()), {});
  ASSERT_TRUE(read) << to_string(read.fault());
  EXPECT_EQ(read->format, "ilc20");
  ASSERT_THAT(read->points, SizeIs(2));
  EXPECT_EQ(read->points[0].walk, "walk-1");
  EXPECT_EQ(read->points[0].device_model, "Phone");
  EXPECT_NEAR(read->points[0].place.point.x_m, 2.0, 1e-9);
  EXPECT_NEAR(read->points[1].place.point.x_m, 6.0, 1e-9);
  EXPECT_EQ(read->points[1].place.floor.value, 1) << "F2";
  EXPECT_EQ(read->points[1].surveyed_at.time_since_epoch().count(), 1560913006000000);
  SurveyFileSettings settings;
  settings.floor = FloorOrdinal{7};
  EXPECT_EQ(read_survey_file(file("walk-1.txt", trace()), settings)->points[0].place.floor.value, 7);
}

TEST_F(SurveyFiles, BrokenLinesOfAWalkAreRowsToo) {
  const auto read = read_survey_file(file("walk-1.txt", trace("1560913009000\tTYPE_WIFI\tname\tnobody\t-60\t5180\t1560913009000\n")), {});
  ASSERT_TRUE(read) << to_string(read.fault());
  ASSERT_THAT(read->bad, SizeIs(1));
  EXPECT_EQ(read->bad[0].row, 37u);
  EXPECT_THAT(read->bad[0].cause, HasSubstr("nobody"));
}

TEST_F(SurveyFiles, GetSensorDataLogsAreWalksInDegrees) {
  constexpr const char* kLog =
      "% LogFile created by the GetSensorData App for Android.\n"
      "POSI;10.000;1;47.37690000;8.54170000;2;0\n"
      "WIFI;12.000;0;a;00:1b:2c:00:00:02;2437;-61\n"
      "POSI;14.000;2;47.37699000;8.54170000;2;0\n";
  EXPECT_THAT(to_string(read_survey_file(file("log.txt", kLog), {}).fault()), HasSubstr("no georeference"));
  SurveyFileSettings settings;
  settings.georeference = Georeference{{47.3769, 8.5417}, 0.0};
  const auto read = read_survey_file(file("log.txt", kLog), settings);
  ASSERT_TRUE(read) << to_string(read.fault());
  EXPECT_EQ(read->format, "getsensordata");
  ASSERT_THAT(read->points, SizeIs(1));
  // Half way of 0.00009 degrees of latitude, 111.18 km each.
  EXPECT_NEAR(read->points[0].place.point.y_m, 5.0, 0.02);
  EXPECT_EQ(read->points[0].place.floor.value, 2);
  EXPECT_THAT(to_string(read_survey_file(file("one.txt", "POSI;10.0;1;47.3769;8.5417;2;0\n"), settings).fault()), HasSubstr("two marks"));
}

TEST_F(SurveyFiles, AreToldByTheirContentOrRefused) {
  EXPECT_EQ(format_of("\xef\xbb\xbf \n{\"type\":"), "geojson");
  EXPECT_EQ(format_of("x_m,y_m,floor,bssid,rss_dbm\n"), "csv");
  EXPECT_EQ(format_of("ACCE;1.0;2.0;0;0;9.8;3\n"), "getsensordata");
  EXPECT_EQ(format_of("Dear surveyor,\n"), "");
  EXPECT_THAT(to_string(read_survey_file(file("a.txt", "Dear surveyor,\n"), {}).fault()), HasSubstr("--format"));
  EXPECT_FALSE(read_survey_file((folder_.path() / "nowhere").string(), {}));
}

}  // namespace
}  // namespace wayfuse::cli
