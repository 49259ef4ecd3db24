#include "server/buildings/device_offsets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/locating/plan.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

/// The hall surveyed by a phone of each model; one hears `offset_db` louder, all with 3 dB of noise. One transmitter was turned
/// up by 20 dB in between.
std::vector<ReferencePoint> surveyed_twice(double offset_db, std::size_t by_other) {
  const Plan plan({"A....B....C", "...........", "D....E....F"}, 4.0);
  Random random(1);
  std::vector<ReferencePoint> survey;
  const auto add = [&](const std::string& model, double louder_db, std::size_t most, bool turned_up) {
    auto points = plan.survey(2);
    points.resize(std::min(points.size(), most));
    for (ReferencePoint& point : points) {
      point.device_model = model;
      for (RssScan& scan : point.scans) {
        for (ScanReading& reading : scan.readings) {
          reading.rss_dbm += louder_db + 3.0 * random.normal() + (turned_up && reading.bssid.value == 0x1000u + 'A' ? 20.0 : 0.0);
        }
      }
      survey.push_back(point);
    }
  };
  add("usual", 0.0, 33, false);
  add("other", offset_db, by_other, true);
  return survey;
}

const DeviceLevel& of(const std::vector<DeviceLevel>& levels, const std::string& model) {
  return *std::ranges::find(levels, model, &DeviceLevel::model);
}

TEST(DeviceOffsets, AreLearntWhereTwoModelsStoodTogether) {
  for (const double offset_db : {-8.0, 5.0}) {
    const auto levels = learn_device_levels(surveyed_twice(offset_db, 20));
    ASSERT_EQ(levels.size(), 2u);
    EXPECT_EQ(levels[0].model, "usual");
    EXPECT_EQ(levels[0].standing, DeviceLevel::Standing::kReference);
    EXPECT_EQ(levels[1].standing, DeviceLevel::Standing::kLearnt);
    EXPECT_NEAR(levels[1].offset_db, offset_db, 1.5);  // one of six transmitters is 20 dB off: it moves the median by about a dB
    EXPECT_EQ(levels[1].points, 20u);
    EXPECT_EQ(levels[1].places, 20u);
    EXPECT_EQ(levels[1].transmitters, 6u);
    EXPECT_EQ(offsets_of(levels), (std::map<std::string, double>{{"other", levels[1].offset_db}}));
  }
}

TEST(DeviceOffsets, AreNotClaimedFromAHandfulOfReadingsOrWithoutAny) {
  const auto unknown = [](const std::vector<ReferencePoint>& survey) {
    const auto levels = learn_device_levels(survey);
    return of(levels, "other").standing == DeviceLevel::Standing::kUnknown && of(levels, "other").offset_db == 0.0;
  };
  EXPECT_TRUE(unknown(surveyed_twice(8.0, 4)));
  EXPECT_TRUE(offsets_of(learn_device_levels(surveyed_twice(8.0, 0))).empty());
  EXPECT_TRUE(learn_device_levels({}).empty());
  auto apart = surveyed_twice(8.0, 20);
  for (ReferencePoint& point : apart) point.place.point.x_m += point.device_model == "other" ? 500.0 : 0.0;
  EXPECT_TRUE(unknown(apart));
  auto other_floor = surveyed_twice(8.0, 20);
  for (ReferencePoint& point : other_floor) point.place.floor.value += point.device_model == "other" ? 1 : 0;
  EXPECT_TRUE(unknown(other_floor));
}

TEST(DeviceOffsets, AModelThatHearsAlikeStaysAsItIs) {
  const auto levels = learn_device_levels(surveyed_twice(0.0, 20));
  EXPECT_EQ(of(levels, "other").standing, DeviceLevel::Standing::kAgrees);
  EXPECT_NEAR(of(levels, "other").offset_db, 0.0, 1.0);
  EXPECT_TRUE(offsets_of(levels).empty());
}

TEST(DeviceOffsets, ReachAModelThatOnlyMetAnotherOne) {
  // usual everywhere in the west half; other at both ends; third only in the east half: it never met the usual one.
  const double usual_until_m = 20.0, third_from_m = 24.0;
  auto survey = surveyed_twice(5.0, 33);
  auto third = surveyed_twice(-4.0, 33);
  std::erase_if(third, [&](const ReferencePoint& point) { return point.device_model != "other" || point.place.point.x_m < third_from_m; });
  for (ReferencePoint& point : third) point.device_model = "third";
  std::erase_if(survey, [&](const ReferencePoint& point) { return point.device_model == "usual" && point.place.point.x_m > usual_until_m; });
  std::vector<ReferencePoint> again;
  for (const ReferencePoint& point : survey) {
    if (point.device_model == "usual") again.push_back(point), again.push_back(point);  // it still surveyed most
  }
  survey.insert(survey.end(), again.begin(), again.end());
  survey.insert(survey.end(), third.begin(), third.end());
  const auto levels = learn_device_levels(survey);
  EXPECT_EQ(levels.front().model, "usual");
  EXPECT_NEAR(of(levels, "other").offset_db, 5.0, 1.5);
  EXPECT_EQ(of(levels, "third").standing, DeviceLevel::Standing::kLearnt);
  EXPECT_NEAR(of(levels, "third").offset_db, -4.0, 2.5);
}

TEST(DeviceOffsets, TheOrderOfUploadSaysNothing) {
  auto survey = surveyed_twice(5.0, 20);
  const auto levels = learn_device_levels(survey);
  EXPECT_EQ(learn_device_levels(survey), levels);
  std::ranges::stable_partition(survey, [](const ReferencePoint& point) { return point.device_model == "other"; });
  EXPECT_EQ(learn_device_levels(survey), levels);
}

TEST(DeviceOffsets, AreTakenOutOfThatModelsReadingsOnly) {
  auto survey = surveyed_twice(5.0, 20);
  const auto before = survey;
  apply_device_offsets({{"other", 5.0}}, survey);
  EXPECT_EQ(survey.front(), before.front());
  EXPECT_NEAR(survey.back().scans[0].readings[0].rss_dbm, before.back().scans[0].readings[0].rss_dbm - 5.0, 1e-9);
}

}  // namespace
}  // namespace wayfuse
