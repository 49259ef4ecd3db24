#include "server/locating/similarity.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wayfuse {
namespace {

RssScan heard(std::vector<std::pair<std::uint64_t, double>> levels) {
  RssScan scan;
  for (const auto& [bssid, rss_dbm] : levels) scan.readings.push_back({Bssid{bssid}, rss_dbm, Duration{0}, 2412, {}, {}});
  return scan;
}

ReferencePoint point(double x_m, int floor, std::vector<std::pair<std::uint64_t, double>> levels) {
  ReferencePoint point;
  point.place = {{x_m, 0}, {floor}};
  point.scans = {heard(std::move(levels))};
  return point;
}

TEST(Similarity, DistancesFollowTheFormulas) {
  const std::vector<ReferencePoint> survey = {point(0, 0, {{1, -50}, {2, -75}}), point(5, 0, {{3, -60}})};
  SimilaritySettings settings;
  settings.floor_dbm = -100;
  settings.power = 1.0;
  settings.cosine = 0.25;
  settings.offset_most_db = 0.0;
  const Similarity model(RadioMap::build(survey), settings);
  KnownScan scan;
  model.map().know(heard({{1, -60}, {2, -50}}), scan);
  std::vector<float> distances;
  Similarity::Sums room;
  model.distances(scan, distances, room);
  // u = (0.4, 0.5), v = (0.5, 0.25): shared 0.4 + 0.25, totals 0.9 + 0.75; product 0.2 + 0.125, norms sqrt(0.41), sqrt(0.3125).
  const double sorensen = 1 - 2 * 0.65 / 1.65;
  const double cosine = 1 - 0.325 / std::sqrt(0.41 * 0.3125);
  EXPECT_NEAR(distances[0], 0.75 * sorensen + 0.25 * cosine, 1e-6);
  EXPECT_FLOAT_EQ(distances[1], 1.0f) << "nothing in common";
}

TEST(Similarity, AMissingTransmitterHardlyCounts) {
  // Two points hear 1 and 2 alike; the second also hears the weak 3..9 that this scan happened to miss. Euclid would flee to
  // the third.
  std::vector<std::pair<std::uint64_t, double>> many = {{1, -45}, {2, -55}};
  for (std::uint64_t weak = 3; weak < 10; ++weak) many.emplace_back(weak, -92);
  const std::vector<ReferencePoint> survey = {point(0, 0, many), point(30, 0, {{1, -70}, {2, -80}})};
  SimilaritySettings settings;
  settings.k = 1;
  const Similarity model(RadioMap::build(survey), settings);
  const auto fix = model.make()->locate(heard({{1, -46}, {2, -54}}));
  ASSERT_TRUE(fix);
  EXPECT_DOUBLE_EQ(fix->place.point.x_m, 0.0);
}

TEST(Similarity, ALouderPhoneStaysWhereItIs) {
  const std::vector<ReferencePoint> survey = {point(0, 0, {{1, -70}, {2, -60}}), point(9, 0, {{1, -62}, {2, -58}})};
  SimilaritySettings settings;
  settings.k = 1;
  const Similarity model(RadioMap::build(survey), settings);
  EXPECT_DOUBLE_EQ(model.make()->locate(heard({{1, -62}, {2, -52}}))->place.point.x_m, 0.0) << "8 dB louder at point 0";
  settings.offset_most_db = 0.0;
  const Similarity strict(RadioMap::build(survey), settings);
  EXPECT_DOUBLE_EQ(strict.make()->locate(heard({{1, -62}, {2, -52}}))->place.point.x_m, 9.0);
}

TEST(Similarity, TheFloorWithTheNearestFingerprintsWins) {
  const std::vector<ReferencePoint> survey = {point(0, 0, {{1, -50}}), point(2, 0, {{1, -52}}),
                                              point(0, 1, {{1, -80}, {2, -50}}), point(2, 1, {{1, -80}, {2, -52}})};
  const Similarity model(RadioMap::build(survey), {});
  const auto locator = model.make();
  const auto fix = locator->locate(heard({{1, -78}, {2, -51}}));
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->place.floor, FloorOrdinal{1});
  EXPECT_EQ(locator->floors().front().floor, FloorOrdinal{1});
  EXPECT_NEAR(locator->floors()[0].probability + locator->floors()[1].probability, 1.0, 1e-12);
  EXPECT_FALSE(locator->locate(heard({{99, -40}}))) << "no transmitter the map knows";
}

}  // namespace
}  // namespace wayfuse
