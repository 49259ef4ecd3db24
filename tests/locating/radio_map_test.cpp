#include "server/locating/radio_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace wayfuse {
namespace {

ScanReading heard(std::uint64_t bssid, double rss_dbm, double age_s = 0.0) {
  return {Bssid{bssid}, rss_dbm, from_seconds(age_s), 0, {}, {}};
}
RssScan scan(std::vector<ScanReading> readings) { return {PhoneTime{}, std::move(readings)}; }
ReferencePoint point(double x_m, std::vector<RssScan> scans, int floor = 0) {
  ReferencePoint made;
  made.place = {{x_m, 0.0}, FloorOrdinal{floor}};
  made.scans = std::move(scans);
  return made;
}

TEST(RadioMap, AveragesScansOfAPointOverThoseThatHeardTheTransmitter) {
  // 7 is heard twice in three scans: (-50 - 54) / 2 = -52, spread sqrt((2^2 + 2^2) / 1) = 2.83; silence is not a number.
  const ReferencePoint survey[] = {point(1.0, {scan({heard(7, -50), heard(9, -80)}), scan({heard(7, -54)}), scan({heard(9, -80)})})};
  const auto map = RadioMap::build(survey);
  ASSERT_EQ(map->points().size(), 1u);
  const auto levels = map->levels(map->points()[0]);
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_EQ(map->transmitters()[levels[0].transmitter], Bssid{7});
  EXPECT_FLOAT_EQ(levels[0].mean_dbm, -52.0f);
  EXPECT_NEAR(levels[0].spread_db, std::sqrt(8.0), 1e-5);
  EXPECT_EQ(levels[0].heard, 2);
  EXPECT_EQ(map->points()[0].scans, 3);
}

TEST(RadioMap, LeavesOutWhatCannotBeUsed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t hot_spot = std::uint64_t{2} << 40;  // locally administered
  const ReferencePoint survey[] = {
      point(1.0, {scan({heard(7, nan), heard(hot_spot, -40), heard(8, -INFINITY)})}),
      point(nan, {scan({heard(7, -50)})}),
      point(2.0, {scan({heard(7, -60)})}, -1),
  };
  const auto map = RadioMap::build(survey);
  ASSERT_EQ(map->points().size(), 1u);
  EXPECT_EQ(map->points()[0].place.floor, FloorOrdinal{-1});
  EXPECT_EQ(map->transmitters().size(), 1u);
}

TEST(RadioMap, KeepsLocallyAdministeredAddressesThatStay) {
  const std::uint64_t stays = std::uint64_t{2} << 40, passes_by = stays + 1;
  const ReferencePoint survey[] = {point(0.0, {scan({heard(stays, -40), heard(passes_by, -40)})}), point(5.0, {scan({heard(stays, -50)})})};
  const auto map = RadioMap::build(survey);
  ASSERT_EQ(map->transmitters().size(), 1u);
  EXPECT_EQ(map->transmitters()[0], Bssid{stays});
}

TEST(RadioMap, KnowsAScanSortedWithTheYoungestReadingOfEach) {
  const ReferencePoint survey[] = {point(0.0, {scan({heard(1, -50), heard(2, -60), heard(3, -70)})})};
  const auto map = RadioMap::build(survey);
  KnownScan known;
  map->know(scan({heard(3, -71), heard(99, -40), heard(1, -51, 2.0), heard(1, -55, 0.5)}), known);
  ASSERT_EQ(known.levels.size(), 2u);
  EXPECT_FLOAT_EQ(known.levels[0].rss_dbm, -55.0f);
  EXPECT_FLOAT_EQ(known.levels[1].rss_dbm, -71.0f);
  EXPECT_EQ(known.unknown, 1);
}

TEST(RadioMap, OfNoSurveyIsEmpty) {
  EXPECT_TRUE(RadioMap::build({})->empty());
  EXPECT_TRUE(RadioMap::build({})->floors().empty());
}

}  // namespace
}  // namespace wayfuse
