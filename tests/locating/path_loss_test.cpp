#include "server/locating/path_loss.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/locating/propagation.hpp"
#include "server/locating/probabilistic.hpp"
#include "server/locating/trilateration.hpp"
#include "tests/locating/plan.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

Plan hall() {
  return Plan({"A.....B",
               ".......",
               ".......",
               ".......",
               "C.....D"}, 5.0);
}

// The plan's law is 30 dB a decade of hypot(d, 1): the fit sees max(d, 1), the same within 0.1 dB beyond 5 m.
TEST(FitPathLoss, FindsTransmitterLevelAndExponent) {
  const auto map = RadioMap::build(hall().survey());
  const auto laws = fit_path_loss(*map);
  ASSERT_EQ(laws.size(), 4u);
  const BuildingPoint corners[] = {{0, 20}, {30, 20}, {0, 0}, {30, 0}};
  for (std::size_t i = 0; i < 4; ++i) {
    ASSERT_TRUE(laws[i]);
    EXPECT_LT(distance_m(laws[i]->transmitter.point, corners[i]), 1.5) << i;
    EXPECT_NEAR(laws[i]->exponent, 3.0, 0.1);
    EXPECT_NEAR(laws[i]->at_1m_dbm, -30.0, 2.0);
    EXPECT_EQ(laws[i]->points, 35);
  }
}

TEST(FitPathLoss, PlacesNothingHeardAtThreePoints) {
  const Plan tiny({"A.."}, 5.0);
  const auto map = RadioMap::build(tiny.survey());
  EXPECT_FALSE(fit_path_loss(*map)[0]);
}

TEST(PathLoss, DistanceUndoesLevel) {
  const PathLoss law{{{0, 0}, {}}, -45.0, 2.2, 1.0, 10};
  for (const double d_m : {1.0, 3.0, 40.0, 300.0}) EXPECT_NEAR(law.distance_m(law.level_dbm(d_m)), d_m, 1e-9);
  EXPECT_TRUE(std::isfinite(law.distance_m(-120.0, kLeastExponent)));
}

TEST(Trilateration, FindsThePlaceOfAScan) {
  const Trilateration model(RadioMap::build(hall().survey()), {});
  const auto locator = model.make();
  for (const BuildingPoint truth : {BuildingPoint{12, 8}, BuildingPoint{22, 13}, BuildingPoint{5, 17}}) {
    const auto fix = locator->locate(hall().scan_at(truth));
    ASSERT_TRUE(fix);
    EXPECT_LT(distance_m(fix->place.point, truth), 2.0);
    EXPECT_EQ(locator->ranges().size(), 4u);
  }
}

TEST(Trilateration, HasNoFixFromTwoOrFromALine) {
  const Trilateration model(RadioMap::build(hall().survey()), {});
  RssScan scan = hall().scan_at({12, 8});
  scan.readings.resize(2);
  EXPECT_FALSE(model.make()->locate(scan));
  const Plan street({"A...B...C"}, 5.0);
  const Trilateration line(RadioMap::build(street.survey()), {});
  const auto fix = line.make()->locate(street.scan_at({12, 0})).value_or(Fix{});
  EXPECT_TRUE(std::isfinite(fix.place.point.x_m) && std::isfinite(fix.place.point.y_m));
}

// Levels that contradict each other: every transmitter as loud as from 1 km away but one. The circles meet nowhere near.
TEST(Trilateration, RefusesASolutionFarOutsideWhatWasSurveyed) {
  const auto map = RadioMap::build(hall().survey());
  RssScan scan = hall().scan_at({12, 8});
  for (std::size_t i = 1; i < scan.readings.size(); ++i) scan.readings[i].rss_dbm = -115.0 - static_cast<double>(i);
  const auto believed = Trilateration(map, {.beyond_m = 100000.0}).make()->locate(scan);
  ASSERT_TRUE(believed);
  EXPECT_GT(std::hypot(believed->place.point.x_m, believed->place.point.y_m), 200.0);
  EXPECT_FALSE(Trilateration(map, {.beyond_m = 50.0}).make()->locate(scan));
}

// [P3 algorithm 2]: the exponents follow the world once the fused position is right, and stay when they are right within T.
TEST(Trilateration, LearnsAnExponentThatChanged) {
  const Trilateration model(RadioMap::build(hall().survey()), {});
  TrilaterationLocator locator(model);
  const std::vector<double> surveyed(locator.exponents().begin(), locator.exponents().end());
  const BuildingPoint truth{12, 8};
  const auto drowned = [&](BuildingPoint at) {
    RssScan scan = hall().scan_at(at);
    for (auto& reading : scan.readings) reading.rss_dbm = -30.0 + (reading.rss_dbm + 30.0) * 3.6 / 3.0;  // exponent 3 -> 3.6
    return scan;
  };
  ASSERT_TRUE(locator.locate(drowned(truth)));
  locator.learn(drowned(truth), {truth, FloorOrdinal{0}});
  for (std::size_t i = 0; i < surveyed.size(); ++i) EXPECT_NEAR(locator.exponents()[i], 3.6, 0.15);
  const auto fix = locator.locate(drowned({15, 10}));
  ASSERT_TRUE(fix);
  EXPECT_LT(distance_m(fix->place.point, {15, 10}), 2.0);
}

// The law's own level at the fused place with exponents `off` the survey's: replaced beyond T = 0.2 by just that, kept to the bit within it.
TEST(Trilateration, ReplacesAnExponentOnlyBeyondTheThreshold) {
  const Trilateration model(RadioMap::build(hall().survey()), {.threshold = 0.2}), deaf(RadioMap::build(hall().survey()), {.threshold = 0.2, .online = false});
  const Place here{{12, 8}, FloorOrdinal{0}};
  for (const double off : {0.15, -0.15, 0.25, -0.25}) {
    RssScan scan = hall().scan_at(here.point);
    for (auto& reading : scan.readings) {
      PathLoss law = *model.laws()[*model.map().index_of(reading.bssid)];
      law.exponent += off;
      reading.rss_dbm = law.level_dbm(distance_m(here.point, law.transmitter.point));
    }
    TrilaterationLocator locator(model), never(deaf);
    locator.learn(scan, here);
    never.learn(scan, here);
    for (std::size_t i = 0; i < model.laws().size(); ++i) {
      const double surveyed = model.laws()[i]->exponent;
      EXPECT_EQ(never.exponents()[i], surveyed) << "the survey's exponents stay";
      if (std::abs(off) < 0.2) {
        EXPECT_EQ(locator.exponents()[i], surveyed) << off;
      } else {
        EXPECT_NEAR(locator.exponents()[i], surveyed + off, 1e-9) << off;
      }
    }
  }
}

TEST(Trilateration, TakesAMeasuredRangeOverALevel) {
  const Trilateration model(RadioMap::build(hall().survey()), {});
  const BuildingPoint truth{12, 8}, corners[] = {{0, 20}, {30, 20}, {0, 0}, {30, 0}};
  RssScan scan = hall().scan_at(truth);
  for (std::size_t i = 0; i < 4; ++i) {
    scan.readings[i].rss_dbm = -90.0;  // nonsense levels, true ranges
    scan.readings[i].range_m = distance_m(truth, corners[i]);
    scan.readings[i].range_sigma_m = 0.5;
  }
  const auto fix = model.make()->locate(scan);
  ASSERT_TRUE(fix);
  EXPECT_LT(distance_m(fix->place.point, truth), 1.5);
}

TEST(Propagation, FindsTheCellOfAScan) {
  const Propagation model(RadioMap::build(hall().survey()), {});
  const auto fix = model.make()->locate(hall().scan_at({12, 8}));
  ASSERT_TRUE(fix);
  EXPECT_LT(distance_m(fix->place.point, {12, 8}), 1.5);
}

TEST(Probabilistic, FindsThePointOfAScanByBothDensities) {
  auto survey = hall().survey();
  Random random(2);
  for (auto& point : survey) {
    for (auto& scan : point.scans) {
      for (auto& reading : scan.readings) reading.rss_dbm += 2.0 * random.normal();
    }
  }
  const auto map = RadioMap::build(survey);
  for (const bool histogram : {false, true}) {
    const Probabilistic model({map, survey, {}}, {.histogram = histogram, .sigma_db = 4.0});
    const auto locator = model.make();
    for (const BuildingPoint truth : {BuildingPoint{10, 10}, BuildingPoint{25, 5}}) {
      const auto fix = locator->locate(hall().scan_at(truth));
      ASSERT_TRUE(fix);
      EXPECT_LT(distance_m(fix->place.point, truth), 4.0) << histogram;
      EXPECT_GT(fix->sigma_m, 0.0);
    }
    EXPECT_FALSE(locator->locate({}));
  }
}

// A door that opens and closes: at the first place 50 or 80 dB, at the second always 57. In the middle of the two, 65, the Gaussian
// believes what nobody ever heard there; the histogram does not. The survey is written from the far end, one scan a point.
TEST(Probabilistic, TheHistogramKnowsLevelsWithTwoTops) {
  std::vector<ReferencePoint> survey;
  const auto hear = [&](double x_m, double rss_dbm) {
    ReferencePoint point;
    point.place = {{x_m, 0.0}, FloorOrdinal{0}};
    point.scans = {{PhoneTime{}, {{Bssid{7}, rss_dbm, {}, 2412, {}, {}}}}};
    survey.push_back(point);
  };
  for (int i = 0; i < 10; ++i) {
    hear(40.0, -57.0);
    hear(0.0, i % 2 ? -50.0 : -80.0);
  }
  const RssScan scan{PhoneTime{}, {{Bssid{7}, -65.0, {}, 2412, {}, {}}}};
  const Probabilistic model({RadioMap::build(survey), survey, {}}, {.histogram = true, .sigma_db = 4.0, .temper = 1.0});
  const auto fix = model.make()->locate(scan);
  ASSERT_TRUE(fix);
  // 8 dB off at 40 m against 15 dB off at the door: e^{-2} to e^{-7}, and e^{-7} more for both that nobody can rule out.
  EXPECT_GT(fix->place.point.x_m, 35.0);
  // At the door half of the readings are just 80 dB; being heard in the one scan of a point is certain.
  const double expected = std::log(0.5 / (4.0 * std::sqrt(2.0 * std::numbers::pi)) + std::exp(-7.0));
  std::vector<double> by_point(model.map().points().size());
  KnownScan known;
  model.map().know({PhoneTime{}, {{Bssid{7}, -80.0, {}, 2412, {}, {}}}}, known);
  model.log_likelihood(known, by_point);
  for (std::size_t j = 0; j < by_point.size(); ++j) {
    if (model.map().points()[j].place.point.x_m > 0.0) continue;
    EXPECT_NEAR(by_point[j], expected, 1e-3);
  }
}

TEST(Probabilistic, OneStrangeReadingDoesNotRuleThePlaceOut) {
  const auto survey = hall().survey();
  const Probabilistic model({RadioMap::build(survey), survey, {}}, {});
  RssScan scan = hall().scan_at({10, 10});
  scan.readings[0].rss_dbm = -20.0;  // somebody put a strong fake beside the phone
  const auto fix = model.make()->locate(scan);
  ASSERT_TRUE(fix);
  EXPECT_LT(distance_m(fix->place.point, {10, 10}), 12.0);
}

}  // namespace
}  // namespace wayfuse
