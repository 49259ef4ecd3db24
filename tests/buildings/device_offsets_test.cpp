#include "server/buildings/device_offsets.hpp"

#include <gtest/gtest.h>

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

TEST(DeviceOffsets, AreLearntWhereTwoModelsStoodTogether) {
  for (const double offset_db : {-8.0, 5.0}) {
    const auto offsets = learn_device_offsets(surveyed_twice(offset_db, 20));
    ASSERT_EQ(offsets.size(), 1u);
    EXPECT_NEAR(offsets.at("other"), offset_db, 1.5);  // one of six transmitters is 20 dB off: it moves the median by about a dB
  }
}

TEST(DeviceOffsets, AreNotClaimedFromAHandfulOfReadingsOrWithoutAny) {
  EXPECT_TRUE(learn_device_offsets(surveyed_twice(8.0, 4)).empty());
  EXPECT_TRUE(learn_device_offsets(surveyed_twice(8.0, 0)).empty());
  EXPECT_TRUE(learn_device_offsets({}).empty());
  auto apart = surveyed_twice(8.0, 20);
  for (ReferencePoint& point : apart) point.place.point.x_m += point.device_model == "other" ? 500.0 : 0.0;
  EXPECT_TRUE(learn_device_offsets(apart).empty());
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
