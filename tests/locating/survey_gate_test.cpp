#include "server/locating/survey_gate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

// Two floors with a corridor of 80 m each, a radio every 6 m, six walks up and down it, a point every 2 s, 3 dB of noise.
constexpr double kLong_m = 80.0;

RssScan scan_at(BuildingPoint p, int floor, double time_s, Random& random) {
  RssScan scan{PhoneTime{from_seconds(time_s)}, {}};
  for (int radio = 0; radio < 14; ++radio) {
    const double d_m = std::hypot(p.x_m - 6.0 * radio, p.y_m - (radio % 2 ? 4.0 : -4.0));
    const double level = -35.0 - 26.0 * std::log10(1.0 + d_m) + 3.0 * random.normal();
    if (level > -92.0) scan.readings.push_back({Bssid{0x2000u + static_cast<unsigned>(floor * 64 + radio)}, level, Duration{0}, 2437, {}, {}});
  }
  return scan;
}

std::vector<ReferencePoint> corridor() {
  std::vector<ReferencePoint> survey;
  Random random(7);
  for (int floor = 0; floor < 2; ++floor) {
    for (int walk = 0; walk < 6; ++walk) {
      for (int i = 0; i <= 32; ++i) {
        const double x_m = walk % 2 ? kLong_m - 2.5 * i : 2.5 * i;
        const BuildingPoint p{x_m, 0.3 * walk};
        survey.push_back({{p, FloorOrdinal{floor}}, 0.0, "phone", "w" + std::to_string(floor * 10 + walk), {}, {scan_at(p, floor, 2.0 * i, random)}});
      }
    }
  }
  return survey;
}

std::set<std::size_t> points_of(const std::vector<SurveyDoubt>& doubts) {
  std::set<std::size_t> points;
  for (const SurveyDoubt& doubt : doubts) points.insert(doubt.point);
  return points;
}

TEST(SurveyGate, AnHonestSurveyPasses) { EXPECT_EQ(doubtful_points(corridor()), std::vector<SurveyDoubt>{}); }

TEST(SurveyGate, StandingPointsThatTookEachOthersPlaceAreFound) {
  auto survey = corridor();
  for (auto& point : survey) point.walk.clear();           // nobody's pace can be judged
  std::swap(survey[40].place, survey[60].place);           // 8th and 28th of the second walk: 50 m apart
  const auto doubts = doubtful_points(survey);
  EXPECT_EQ(points_of(doubts), (std::set<std::size_t>{40, 60}));
  for (const SurveyDoubt& doubt : doubts) {
    EXPECT_EQ(doubt.cause, SurveyDoubt::Cause::kRadio);
    EXPECT_NEAR(doubt.off_m, 50.0, 12.0);
  }
}

TEST(SurveyGate, APointOnAWrongFloorIsFoundAndSaysSo) {
  auto survey = corridor();
  survey[45].place.floor = FloorOrdinal{1};
  const auto doubts = doubtful_points(survey);
  ASSERT_EQ(points_of(doubts), (std::set<std::size_t>{45}));
  EXPECT_EQ(doubts[0].heard_at.floor, FloorOrdinal{0});
  EXPECT_TRUE(std::isinf(doubts[0].off_m));
  EXPECT_NE(to_string(doubts[0]).find("floor 0"), std::string::npos);
}

TEST(SurveyGate, AWholeWalkOutOfPlaceIsNamedAsOne) {
  auto survey = corridor();
  std::set<std::size_t> moved;
  for (std::size_t i = 0; i < survey.size(); ++i) {
    if (survey[i].walk != "w3") continue;
    survey[i].place.point.x_m = kLong_m - survey[i].place.point.x_m;  // marked in the wrong order
    moved.insert(i);
  }
  const auto doubts = doubtful_points(survey);
  std::size_t whole = 0;
  for (const SurveyDoubt& doubt : doubts) {
    EXPECT_TRUE(moved.contains(doubt.point)) << to_string(doubt);
    whole += doubt.cause == SurveyDoubt::Cause::kWalk;
  }
  EXPECT_GE(whole, 30u) << "of 33: the corridor's middle stays where it is";
}

// A store beside the corridor's end that one walk surveyed, behind a wall that lets through what comes down the corridor: what it
// hears is a little like the corridor's far middle and like nothing around, and unlike both.
TEST(SurveyGate, TheOnlyWalkOfARoomFitsNowhereWellAndStays) {
  auto survey = corridor();
  Random random(11);
  for (int i = 0; i <= 12; ++i) {
    const BuildingPoint p{0.5 * i, 9.0};
    RssScan scan = scan_at({25.0 + 0.5 * i, 0.0}, 0, 2.0 * i, random);
    for (ScanReading& reading : scan.readings) reading.rss_dbm -= 4.0;
    for (unsigned own = 0; own < 2; ++own) scan.readings.push_back({Bssid{0x3000u + own}, -48.0 + 3.0 * random.normal(), Duration{0}, 2437, {}, {}});
    survey.push_back({{p, FloorOrdinal{0}}, 0.0, "phone", "store", {}, {scan}});
  }
  EXPECT_EQ(doubtful_points(survey), std::vector<SurveyDoubt>{});
}

TEST(SurveyGate, ALeapInTheMiddleOfAWalkNeedsNoWitness) {
  std::vector<ReferencePoint> survey;
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const BuildingPoint p{2.5 * i, i == 9 ? 60.0 : 0.0};
    survey.push_back({{p, FloorOrdinal{0}}, 0.0, "phone", "alone", {}, {scan_at({2.5 * i, 0.0}, 0, 2.0 * i, random)}});
  }
  const auto doubts = doubtful_points(survey);
  ASSERT_EQ(points_of(doubts), (std::set<std::size_t>{9}));
  EXPECT_EQ(doubts[0].cause, SurveyDoubt::Cause::kPace);
  EXPECT_EQ(to_string(doubts[0].cause), "pace");
}

TEST(SurveyGate, FewOrEmptyOrUnplacedPointsAreNobodysFault) {
  EXPECT_TRUE(doubtful_points({}).empty());
  auto survey = corridor();
  survey.resize(1);
  EXPECT_TRUE(doubtful_points(survey).empty());
  survey = corridor();
  survey[3].place.point.x_m = NAN;
  survey[5].scans.clear();
  survey[7].scans[0].readings.resize(2);
  EXPECT_TRUE(doubtful_points(survey).empty());
}

}  // namespace
}  // namespace wayfuse
