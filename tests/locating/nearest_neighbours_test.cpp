#include "server/locating/nearest_neighbours.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/locating/plan.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

Plan office() {
  return Plan({"A....B",
               "......",
               "......",
               "C....D"}, 5.0);
}

std::unique_ptr<NearestNeighbours> model(const std::vector<ReferencePoint>& survey, int k, bool weighted, double exponent = 2.0) {
  return std::make_unique<NearestNeighbours>(RadioMap::build(survey),
                                             NearestNeighboursSettings{k, weighted, {exponent, -100.0}});
}

// The definition, word for word: every transmitter of the map, the floor where one side does not hear it.
double distance_by_definition(const RadioMap& map, const MapPoint& point, const RssScan& scan, double exponent, double floor_dbm) {
  std::map<Bssid, std::pair<double, double>> sides;
  for (const MapLevel& level : map.levels(point)) {
    sides.try_emplace(map.transmitters()[level.transmitter], floor_dbm, floor_dbm).first->second.second = level.mean_dbm;
  }
  for (const ScanReading& reading : scan.readings) {
    if (!map.index_of(reading.bssid)) continue;
    sides.try_emplace(reading.bssid, floor_dbm, floor_dbm).first->second.first = reading.rss_dbm;
  }
  double sum = 0.0;
  for (const auto& [_, side] : sides) sum += std::pow(std::abs(side.first - side.second), exponent);
  return sum;
}

TEST(RssDistance, EqualsItsDefinitionOnRandomSparseMaps) {
  Random random(5);
  for (const double exponent : {0.5, 1.0, 1.5, 2.0, 3.0}) {
    std::vector<ReferencePoint> survey(50);
    const auto readings = [&] {
      std::vector<ScanReading> made;
      for (std::uint64_t bssid = 1; bssid <= 30; ++bssid) {
        if (random.uniform() < 0.3) made.push_back({Bssid{bssid}, std::round(-104.0 + 69.0 * random.uniform()), {}, 0, {}, {}});
      }
      made.push_back({Bssid{100 + random.below(2)}, -60.0, {}, 0, {}, {}});
      return made;
    };
    for (auto& point : survey) point.scans = {{PhoneTime{}, readings()}};
    const auto map = RadioMap::build(survey);
    const RssDistance distance(map, {exponent, -100.0});
    const RssScan scan{PhoneTime{}, readings()};
    KnownScan known;
    map->know(scan, known);
    RssDistance::Approximate found;
    distance.approximate(known, found);
    std::vector<RssDistance::Neighbour> all;
    for (std::uint32_t j = 0; j < map->points().size(); ++j) {
      const double expected = distance_by_definition(*map, map->points()[j], scan, exponent, -100.0);
      EXPECT_NEAR(distance.powered(known, j), expected, 1e-9 * std::max(1.0, expected)) << "exponent " << exponent;
      EXPECT_NEAR(distance.powered(found, j), expected, found.bound) << "exponent " << exponent;
      all.push_back({j, distance.powered(known, j)});
    }
    std::ranges::sort(all, std::less<>{});
    for (const std::size_t k : {1u, 5u, 50u, 64u}) {
      std::vector<RssDistance::Neighbour> nearest;
      distance.nearest(known, found, k, 0, static_cast<std::uint32_t>(all.size()), nearest);
      ASSERT_EQ(nearest.size(), std::min(k, all.size()));
      for (std::size_t i = 0; i < nearest.size(); ++i) EXPECT_EQ(nearest[i].point, all[i].point) << "exponent " << exponent;
    }
  }
}

TEST(NearestNeighbours, StandsOnTheFingerprintItRepeats) {
  const Plan plan = office();
  const auto locator = model(plan.survey(), 1, false)->make();
  (void)locator;
  const auto nn = model(plan.survey(), 1, false);
  const auto fix = nn->make()->locate(plan.scan_at({10.0, 5.0}));
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->place.point, (BuildingPoint{10.0, 5.0}));
  EXPECT_EQ(fix->transmitters, 4);
}

TEST(WknnLocator, LeansTowardsTheNearerFingerprint) {
  const Plan plan = office();
  const auto wknn = model(plan.survey(), 2, true);
  const auto knn = model(plan.survey(), 2, false);
  const RssScan scan = plan.scan_at({11.0, 5.0});  // neighbours at x = 10 and x = 15 or the rows beside
  const auto weighted = wknn->make()->locate(scan);
  const auto plain = knn->make()->locate(scan);
  ASSERT_TRUE(weighted && plain);
  EXPECT_LT(distance_m(weighted->place.point, {11.0, 5.0}), distance_m(plain->place.point, {11.0, 5.0}));
}

TEST(WknnLocator, WeighsByTheInverseOfTheDistance) {
  // One transmitter, points at -50 and -60, scan at -53: D = 3 and 7, weights 7/10 and 3/10 [P1 eq. 3], x = 0.3 * 10 = 3.
  std::vector<ReferencePoint> survey(2);
  for (int i = 0; i < 2; ++i) {
    survey[i].place = {{10.0 * i, 0.0}, FloorOrdinal{0}};
    survey[i].scans = {{PhoneTime{}, {{Bssid{7}, -50.0 - 10.0 * i, {}, 0, {}, {}}}}};
  }
  const auto wknn = model(survey, 2, true);
  const auto fix = wknn->make()->locate({PhoneTime{}, {{Bssid{7}, -53.0, {}, 0, {}, {}}}});
  ASSERT_TRUE(fix);
  EXPECT_NEAR(fix->place.point.x_m, 3.0, 1e-5);
}

TEST(NearestNeighbours, TakesTheFloorMostNeighboursStandOn) {
  auto survey = office().survey();
  const Plan above({"A....B",
                    "......",
                    "......",
                    "C....D"}, 5.0, 1);
  for (auto& point : above.survey()) survey.push_back(point);
  const auto wknn = model(survey, 4, true);
  const auto locator = wknn->make();
  const auto fix = locator->locate(above.scan_at({12.0, 7.0}));
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->place.floor, FloorOrdinal{1});
  EXPECT_EQ(locator->floors().front().floor, FloorOrdinal{1});
}

TEST(NearestNeighbours, GivesNoFixOnUnknownTransmittersOrAnEmptyMap) {
  const RssScan strange{PhoneTime{}, {{Bssid{0xabc}, -40.0, {}, 0, {}, {}}}};
  const auto known = model(office().survey(), 4, true);
  const auto empty = model({}, 4, true);
  EXPECT_FALSE(known->make()->locate(strange));
  EXPECT_FALSE(known->make()->locate({}));
  EXPECT_FALSE(empty->make()->locate(strange));
}

TEST(NearestNeighbours, DoesNotDependOnTheOrderOfSurveyOrScan) {
  const Plan plan = office();
  auto survey = plan.survey();
  auto scan = plan.scan_at({7.0, 3.0});
  const auto straight = model(survey, 4, true);
  const auto first = straight->make()->locate(scan);
  std::ranges::reverse(survey);
  std::ranges::reverse(scan.readings);
  const auto turned = model(survey, 4, true);
  const auto second = turned->make()->locate(scan);
  ASSERT_TRUE(first && second);
  EXPECT_NEAR(first->place.point.x_m, second->place.point.x_m, 1e-9);
  EXPECT_NEAR(first->place.point.y_m, second->place.point.y_m, 1e-9);
}

}  // namespace
}  // namespace wayfuse
