#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "sdk/src/recording/import/fingerprint_table.hpp"
#include "tests/evaluation/datasets/levels_table.hpp"
#include "tests/evaluation/datasets/uji_collection.hpp"
#include "tests/evaluation/written_files.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

using FingerprintFile = WrittenFiles;

TEST_F(FingerprintFile, UjiColumnsAreFoundByName) {
  const std::string file =
      write("t.csv",
            "WAP001,WAP002,WAP003,LONGITUDE,LATITUDE,FLOOR,BUILDINGID,SPACEID,RELATIVEPOSITION,USERID,PHONEID,TIMESTAMP\n"
            "100,-50,-70,-7541.26,4864921.0,2,1,106,2,2,23,1371713733\n");
  const auto table = read_uji(file);
  ASSERT_TRUE(table) << to_string(table.fault());
  ASSERT_EQ(table->scans.size(), 1u);
  EXPECT_EQ(table->access_points, 3u);
  ASSERT_EQ(table->scans[0].heard.size(), 2u);
  EXPECT_EQ(table->scans[0].heard[1].access_point, 2);
  EXPECT_EQ(table->scans[0].floor.value, 2);
  EXPECT_EQ(table->scans[0].phone, 23);
  const auto bad = read_uji(write("b.csv", "WAP001,LONGITUDE,LATITUDE,FLOOR\n-50,1,2,0\n-500,1,2,0\n"));
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.fault().field.find("b.csv:3"), std::string::npos);
  std::vector<BadRow> rows;
  const auto rest = read_uji((folder_ / "b.csv").string(), &rows);
  ASSERT_TRUE(rest);
  EXPECT_EQ(rest->scans.size(), 1u);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].line, 3);
  EXPECT_EQ(rows[0].column, "WAP001");
}

TEST_F(FingerprintFile, UjiTablesComeInManyHands) {
  // Another order of columns, small letters, quotes, an index, blank lines, nothing and nan for not heard.
  const auto table = read_uji(write("t.csv", ",longitude,latitude,floor,\"wap002\",wap001\n0,1,2,-1,\"-50\",\n\n  \n1,1,2,0,nan,-60\n"));
  ASSERT_TRUE(table) << to_string(table.fault());
  ASSERT_EQ(table->scans.size(), 2u);
  EXPECT_EQ(table->names, (std::vector<std::string>{"WAP002", "WAP001"}));
  ASSERT_EQ(table->scans[0].heard.size(), 1u);
  EXPECT_EQ(table->scans[0].heard[0].access_point, 0);
  EXPECT_EQ(table->scans[0].floor.value, -1);
  auto other = read_uji(write("o.csv", "WAP001;WAP002;LONGITUDE;LATITUDE;FLOOR\n-70;-80;1;2;0\n"));
  ASSERT_TRUE(other) << to_string(other.fault());
  ASSERT_TRUE(number_like(*table, *other));
  EXPECT_EQ(other->scans[0].heard[0].rss_dbm, -80.0) << "WAP002 is the first access point there";
  auto stranger = read_uji(write("s.csv", "WAP001,WAP003,LONGITUDE,LATITUDE,FLOOR\n-70,-80,1,2,0\n"));
  EXPECT_FALSE(number_like(*table, *stranger));
  EXPECT_EQ(stranger->scans[0].heard[0].rss_dbm, -70.0);
}

TEST_F(FingerprintFile, ALevelThatFillsMostCellsIsNone) {
  const auto heard = [&](const std::string& not_heard) {
    std::string text = "WAP001,WAP002,WAP003,LONGITUDE,LATITUDE,FLOOR\n";
    for (int i = 0; i < 4; ++i) text += "-50," + not_heard + "," + not_heard + ",1,2,0\n";
    return read_uji(write("t.csv", text))->scans.at(0).heard.size();
  };
  for (const char* not_heard : {"100", "0", "-100", "-105", "-110", ""}) EXPECT_EQ(heard(not_heard), 1u) << not_heard;
  EXPECT_EQ(heard("-99"), 3u);
  EXPECT_EQ(read_uji(write("z.csv", "WAP001,WAP002,LONGITUDE,LATITUDE,FLOOR\n0,100,1,2,0\n100,100,1,2,0\n"))->scans[0].heard.size(), 1u) << "a level of 0 dBm";
}

TEST_F(FingerprintFile, UjiFilesAreFoundInAnyCaseAndOneFolderBelow) {
  EXPECT_FALSE(find_uji(folder_.string()));
  write("__MACOSX/trainingData.csv", "");
  write("__MACOSX/validationData.csv", "");
  EXPECT_FALSE(find_uji(folder_.string()));
  const std::string training = write("UJIndoorLoc/1478_TrainingData.csv", ""), validation = write("UJIndoorLoc/ValidationData.csv", "");
  write("UJIndoorLoc/trainingData.csv.bak", "");
  const auto found = find_uji(folder_.string());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->training, training);
  EXPECT_EQ(found->validation, validation);
}

TEST_F(FingerprintFile, UnitsAreToldByTheCoordinates) {
  const auto metres = [](double x, double y, double extent) {
    FingerprintTable table;
    table.scans.resize(2);
    table.scans[0].point = {x, y};
    table.scans[1].point = {x + extent, y + extent};
    const auto scale = metres_per_unit(table, "t.csv");
    return scale ? *scale : -1.0;
  };
  EXPECT_EQ(metres(-7600, 4864800, 200), kUjiMetresPerUnit);
  EXPECT_NEAR(metres(2650000, 8740000, 100), 0.477, 0.01) << "Tampere's latitude, 61.5 degrees";
  EXPECT_EQ(metres(10, 20, 100), 1.0);
  EXPECT_EQ(metres(-0.068, 39.99, 0.002), -1.0) << "degrees";
}

// Three scans over two access points: (-50, not heard), (not heard, -60), (-40, -41), on floors 0, 1 and 2 of a house.
struct Spelt {
  const char* name;
  const char* levels;
  const char* places;
};
class LevelsFile : public FingerprintFile, public ::testing::WithParamInterface<Spelt> {};
INSTANTIATE_TEST_SUITE_P(
    Spellings, LevelsFile,
    ::testing::Values(Spelt{"Plain", "-50,100\n100,-60\n-40,-41\n", "1,2,0\n3,4,3.7\n5,6,7.4\n"},
                      Spelt{"Plus", "-50,+100\r\n+100,-60\r\n-40,-41\r\n", "1,2,0\n3,4,1\n5,6,2\n"},
                      Spelt{"Decimals", "-50.0,100.0\n100.0,-60.0\n-40.0,-41.0\n", "1.0,2.0,0.0\n3.0,4.0,1.0\n5.0,6.0,2.0\n"},
                      Spelt{"Header", "WAP1,WAP2\n-50,100\n100,-60\n-40,-41\n", "\"x\",\"y\",\"floor\"\n1,2,3\n3,4,4\n5,6,5\n"},
                      Spelt{"Turned", "-50,100,-40\n100,-60,-41\n", "1,2,0\n3,4,3.7\n5,6,7.4\n"},
                      Spelt{"Blanks", "-50 100\n 100 -60\n-40  -41\n", "1 2 0\n3 4 3.7\n5 6 7.4\n"},
                      Spelt{"Tabs", "-50\tnan\nNaN\t-60\n-40\t-41\n", "1\t2\t0\n3\t4\t3.7\n5\t6\t7.4\n"},
                      Spelt{"Semicolons", "-50;\n;-60\n-40;-41\n", "1;2;0\n3;4;3.7\n5;6;7.4\n"},
                      Spelt{"Below", "-50,-110\n-110,-60\n-40,-41\n", "1,2,0,9,9\n3,4,3.7,9,9\n5,6,7.4,9,9\n"},
                      Spelt{"Zeros", "-50,0\n0,-60\n-40,-41\n", "1,2,0\n3,4,3.7\n5,6,7.4\n"},
                      Spelt{"DecimalCommas", "-50,0;100\n100;-60\n-40;-41\n", "1,0;2,0;0\n3,0;4;3,7\n5;6;7,4\n"},
                      Spelt{"Words", "-50,None\n?,-60\n-40,-41\n", "1,2,0\n3,4,3.7\n5,6,7.4\n"},
                      Spelt{"FloorFirst", "-50,100\n100,-60\n-40,-41\n", "floor,x,y\n0,1,2\n1,3,4\n2,5,6\n"},
                      Spelt{"Swapped", "-50,100\n100,-60\n-40,-41\n", "y (m),x (m),Floor_ID\n2,1,0\n4,3,1\n6,5,2\n"},
                      Spelt{"Indexed", "id,AP1,AP2\n0,-50,100\n1,100,-60\n2,-40,-41\n", ",x,y,z\n0,1,2,0\n1,3,4,3.7\n2,5,6,7.4\n"},
                      Spelt{"Numbered", "0,1\n-50,100\n100,-60\n-40,-41\n", "0,1,2\n1,2,0\n3,4,3.7\n5,6,7.4\n"},
                      Spelt{"OneNumbered", "0,1\n-50,100\n100,-60\n-40,-41\n", "1,2,0\n3,4,3.7\n5,6,7.4\n"},
                      Spelt{"AboveMinus100", "50,0\n0,40\n60,59\n", "1,2,0\n3,4,3.7\n5,6,7.4\n"}),
    [](const auto& made) { return std::string(made.param.name); });

TEST_P(LevelsFile, IsReadHoweverItIsSpelt) {
  const LevelsFiles files[] = {{write("rss.csv", GetParam().levels), write("crd.csv", GetParam().places), ""}};
  const auto tables = read_levels(files);
  ASSERT_TRUE(tables) << to_string(tables.fault());
  const FingerprintTable& table = tables->at(0);
  ASSERT_EQ(table.scans.size(), 3u);
  EXPECT_EQ(table.access_points, 2u);
  const std::vector<std::map<int, double>> expected = {{{0, -50}}, {{1, -60}}, {{0, -40}, {1, -41}}};
  for (std::size_t i = 0; i < 3; ++i) {
    std::map<int, double> heard;
    for (const auto& each : table.scans[i].heard) heard[each.access_point] = each.rss_dbm;
    EXPECT_EQ(heard, expected[i]) << i;
    EXPECT_EQ(table.scans[i].floor.value, static_cast<int>(i));
    EXPECT_EQ(table.scans[i].point, (BuildingPoint{1.0 + 2.0 * static_cast<double>(i), 2.0 + 2.0 * static_cast<double>(i)}));
  }
}

TEST_F(FingerprintFile, FloorsOfTrainingAndTestAreCountedAlike) {
  const LevelsFiles files[] = {{write("a_rss.csv", "-50\n-60\n-70\n"), write("a_crd.csv", "0,0,0\n0,0,3.5\n0,0,7\n"), ""},
                               {write("b_rss.csv", "-50\n-60\n"), write("b_crd.csv", "0,0,7.2\n0,0,3.5\n"), ""}};
  const auto tables = read_levels(files);
  ASSERT_TRUE(tables) << to_string(tables.fault());
  EXPECT_EQ(tables->at(1).scans[0].floor.value, 2) << "0.2 m above another point of its floor";
  EXPECT_EQ(tables->at(1).scans[1].floor.value, 1);
}

TEST_F(FingerprintFile, LevelsThatDoNotFitTheirPlacesAreRefusedByName) {
  const auto fault = [&](const char* levels, const char* places) {
    const LevelsFiles files[] = {{write("rss.csv", levels), write("crd.csv", places), ""}};
    const auto tables = read_levels(files);
    return tables ? std::string("none") : to_string(tables.fault());
  };
  EXPECT_NE(fault("-50,-60\n", "1,2,0\n3,4,0\n3,5,0\n").find("3 places"), std::string::npos);
  EXPECT_NE(fault("-50,-60\n-50\n", "1,2,0\n3,4,0\n").find("rss.csv:2"), std::string::npos);
  EXPECT_NE(fault("-50,x\n-50,y\n-50,-3\n", "1,2,0\n3,4,0\n").find("column 2"), std::string::npos);
  EXPECT_NE(fault("", "1,2,0\n").find("no numbers"), std::string::npos);
  const std::string nineteen = "-50,100,100,100,100,100,100,100,100,100,100,100,100,100,100,100,100,100,100\n";
  std::string seventeen;
  for (int i = 0; i < 17; ++i) seventeen += nineteen;
  EXPECT_NE(fault("1,2,0\n3,4,0\n", seventeen.c_str()).find("the file of levels comes first"), std::string::npos);
  EXPECT_NE(fault("-50,-60\n-50,-60\n", "lon,lat,floor\n-0.0681,39.9931,0\n-0.0682,39.9932,1\n").find("degrees"), std::string::npos);
  EXPECT_NE(fault("-50,-500\n-50,-60\n-51,-61\n-52,-62\n-53,-63\n-54,-64\n", "1,2\n1,2\n1,2\n1,2\n1,2\n1,2\n").find("-120..0"), std::string::npos);
}

TEST_F(FingerprintFile, ALevelOfMinus100ThatFillsMostCellsIsNone) {
  const auto heard = [&](const char* levels) {
    const LevelsFiles files[] = {{write("rss.csv", levels), write("crd.csv", "0,0\n0,1\n"), ""}};
    return read_levels(files).value().at(0).scans.at(0).heard.size();
  };
  EXPECT_EQ(heard("-50,-100,-100\n-50,-100,-60\n"), 3u) << "half of them are no more than half";
  EXPECT_EQ(heard("-50,-100,-100\n-50,-100,-100\n"), 1u);
}

TEST_F(FingerprintFile, DecibelsAboveMinus100MayLieALittleBelow) {
  const LevelsFiles files[] = {{write("rss.csv", "50,0,-4\n40,60,0\n"), write("crd.csv", "0,0\n0,1\n"), ""}};
  const auto tables = read_levels(files);
  ASSERT_TRUE(tables) << to_string(tables.fault());
  ASSERT_EQ(tables->at(0).scans[0].heard.size(), 2u);
  EXPECT_EQ(tables->at(0).scans[0].heard[0].rss_dbm, -50.0);
  EXPECT_EQ(tables->at(0).scans[0].heard[1].rss_dbm, -104.0);
}

TEST_F(FingerprintFile, NamedAccessPointsOfATestTableAreMatchedByName) {
  const LevelsFiles files[] = {{write("a_rss.csv", "A,B\n-50,-60\n"), write("a_crd.csv", "0,0\n"), ""},
                               {write("b_rss.csv", "B,A\n-60,-50\n"), write("b_crd.csv", "0,0\n"), ""}};
  const auto tables = read_levels(files);
  ASSERT_TRUE(tables) << to_string(tables.fault());
  EXPECT_EQ(tables->at(1).scans[0].heard.at(0).rss_dbm, -50.0);
}

TEST_F(FingerprintFile, WhatLiesBesideACollectionIsPassedOver) {
  for (const char* part : {"Training", "Test"}) {
    write("db/" + std::string(part) + "_rss.csv", "-50,100\n");
    write("db/" + std::string(part) + "_coordinates.csv", "1,2,3\n");
  }
  for (const char* other : {"db/__MACOSX/._Training_rss.csv", "db/.Test_rss.csv", "db/Training_rss.csv.bak", "db/rss_readme.txt", "db/Test_rss.txt~"}) write(other, "x");
  fs::create_directories(folder_ / "links");
  fs::create_directory_symlink(folder_ / "db", folder_ / "links/to");
  for (const char* folder : {"db", "links"}) {
    const auto found = find_levels((folder_ / folder).string());
    ASSERT_TRUE(found) << folder << to_string(found.fault());
    EXPECT_EQ(found->training.size(), 1u) << folder;
    EXPECT_EQ(found->test.size(), 1u) << folder;
  }
}

TEST_F(FingerprintFile, MonthsOfALibraryAreFoundByTheirNames) {
  for (const char* month : {"01", "02"}) {
    std::filesystem::create_directories(folder_ / "db" / month);
    for (const char* name : {"trn01", "tst01", "tst02"}) {
      write("db/" + std::string(month) + "/" + name + "rss.csv", "-50,100\n");
      write("db/" + std::string(month) + "/" + name + "crd.csv", "1,2,3\n");
      write("db/" + std::string(month) + "/" + name + "tms.csv", "20160601\n");
    }
  }
  const auto found = find_levels((folder_ / "db").string());
  ASSERT_TRUE(found) << to_string(found.fault());
  ASSERT_EQ(found->training.size(), 1u) << "the first month's";
  ASSERT_EQ(found->test.size(), 4u);
  EXPECT_EQ(found->test[3].part, "02");
  EXPECT_NE(found->test[3].places.find("tst02crd"), std::string::npos);
  EXPECT_FALSE(find_levels((folder_ / "db/nowhere").string()));
}

}  // namespace
}  // namespace wayfuse
