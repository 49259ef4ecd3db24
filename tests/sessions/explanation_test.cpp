#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sessions/session_house.hpp"

namespace wayfuse {
namespace {

constexpr Bssid kA{0x1000u + 'A'};  // see Plan
constexpr Bssid kStranger{0x9999};

/// A phone in the middle of the hall: the access point A sounds 20 dB too weak there, and one is heard that nobody surveyed.
RssScan odd_scan(double time_s) {
  RssScan scan = SessionHouse::hall().scan_at({20, 4}, at(time_s));
  for (ScanReading& reading : scan.readings) reading.rss_dbm -= reading.bssid == kA ? 20.0 : 0.0;
  scan.readings.push_back({kStranger, -70.0, Duration{0}, 2412, {}, {}});
  return scan;
}

class ExplanationOf : public testing::TestWithParam<const char*> {
 protected:
  ExplanationOf() {
    Hello hello = track_hello(house_.add_building("Hall", true));
    hello.pipeline = GetParam();
    house_.call(caller_);
    caller_.say(hello);
  }
  std::shared_ptr<TrackingSession> session() { return house_.sessions.find_tracked(caller_.output.last<Welcome>().tracked); }

  SessionHouse house_;
  Caller caller_;
};

TEST_P(ExplanationOf, HoldsEachReadingAgainstTheSurveyAroundTheFix) {
  caller_.say(numbered(1, {step_at(1.0), odd_scan(1.1)}));
  const auto explained = session()->explain();
  ASSERT_TRUE(explained) << to_string(explained.fault());
  EXPECT_EQ(explained->tracked, caller_.output.last<Welcome>().tracked);
  EXPECT_EQ(explained->pipeline, GetParam());
  EXPECT_EQ(explained->position, caller_.output.last<Position>().position);
  EXPECT_GE(explained->surveyed_points, 4);
  ASSERT_EQ(explained->readings.size(), odd_scan(0).readings.size());
  // At 12..28 m from A levels lie between -62.4 and -73.4 dBm; A was heard at -69.3 - 20.
  EXPECT_EQ(explained->readings.front().bssid, kA);
  EXPECT_NEAR(*explained->readings.front().residual_db(), -20.0, 7.0);
  EXPECT_TRUE(explained->readings.front().rejected.empty());
  EXPECT_EQ(explained->readings.back().bssid, kStranger);
  EXPECT_EQ(explained->readings.back().rejected, "not on the map");
  EXPECT_FALSE(explained->readings.back().expected_dbm);
}

TEST_P(ExplanationOf, HasReasonsExactlyWhereTheIntegrityIsInDoubt) {
  std::vector<SampleBody> walk;
  for (int i = 1; i <= 12; ++i) {
    walk.push_back(step_at(0.5 * i));
    if (i == 3) walk.push_back(odd_scan(0.5 * i));
  }
  caller_.say(numbered(1, walk));
  for (std::uint64_t i = 0; i < 90; ++i) {  // no scan for 45 s: the last one is stale
    caller_.say(numbered(13 + 1 + i, {step_at(6.5 + 0.5 * static_cast<double>(i))}));
    const auto explained = session()->explain();
    ASSERT_TRUE(explained);
    EXPECT_EQ(explained->position.integrity == Integrity::kOk, explained->doubts.empty());
  }
  EXPECT_NE(session()->explain()->position.integrity, Integrity::kOk);
}

TEST_P(ExplanationOf, ShowsASampleOfTheCloudAroundItsPosition) {
  caller_.say(numbered(1, {step_at(1.0), odd_scan(1.1)}));
  const auto explained = session()->explain();
  ASSERT_TRUE(explained);
  if (explained->particles.empty()) {
    EXPECT_STREQ(GetParam(), "nn") << "the only one here without particles";
    return;
  }
  EXPECT_LE(explained->particles.size(), 500u);
  double weight = 0.0, x_m = 0.0, y_m = 0.0;
  for (const auto& each : explained->particles) {
    weight += each.weight, x_m += each.weight * each.point.x_m, y_m += each.weight * each.point.y_m;
  }
  EXPECT_NEAR(weight, 1.0, 1e-9);
  EXPECT_LT(distance_m({x_m, y_m}, explained->position.place.point), explained->position.radius68_m + 0.5);
}

TEST_P(ExplanationOf, ChangesNothing) {
  SessionHouse other;
  Caller unasked;
  Hello hello = track_hello(other.add_building("Hall", true));
  hello.pipeline = GetParam();
  other.call(unasked);
  unasked.say(hello);
  for (std::uint64_t i = 1; i <= 20; ++i) {
    const double time_s = 0.5 * static_cast<double>(i);
    const SampleBody body = i % 4 == 1 ? SampleBody(odd_scan(time_s)) : SampleBody(step_at(time_s));
    caller_.say(numbered(i, {body}));
    unasked.say(numbered(i, {body}));
    EXPECT_TRUE(session()->explain());
    EXPECT_EQ(caller_.output.last<Position>().position, unasked.output.last<Position>().position);
  }
}

INSTANTIATE_TEST_SUITE_P(Pipelines, ExplanationOf, testing::Values("default", "p1", "nn"),
                         [](const auto& made) { return std::string(made.param).substr(0, 2); });

TEST(Explanation, SaysThatAReadingWasToldBefore) {
  SessionHouse house;
  Hello hello = track_hello(house.add_building("Hall", true));
  hello.pipeline = "p1";
  Caller caller;
  house.call(caller);
  caller.say(hello);
  RssScan again = odd_scan(2.1);  // what the phone's cache holds: heard a second ago
  for (ScanReading& reading : again.readings) reading.age = from_seconds(1.0);
  RssScan aged = odd_scan(2.2);
  aged.readings.resize(1);
  aged.readings[0].age = from_seconds(60.0);
  caller.say(numbered(1, {step_at(1.0), odd_scan(1.1), again}));
  const auto session = house.sessions.find_tracked(caller.output.last<Welcome>().tracked);
  EXPECT_EQ(session->explain()->readings.front().rejected, "told before: a copy out of the phone's cache");
  caller.say(numbered(4, {aged}));
  EXPECT_EQ(session->explain()->readings.front().rejected, "older than this pipeline takes");
}

TEST(Explanation, SaysWhyThereIsNoPosition) {
  SessionHouse house;
  Caller caller;
  house.call(caller);
  caller.say(track_hello(house.add_building("Hall", false)));
  const auto session = house.sessions.find_tracked(caller.output.last<Welcome>().tracked);
  ASSERT_TRUE(session);
  EXPECT_EQ(session->explain().fault().code, FaultCode::kConflict);
  caller.say(numbered(1, {odd_scan(1.0)}));
  const Fault none = session->explain().fault();
  EXPECT_EQ(none.code, FaultCode::kConflict);
  EXPECT_EQ(none.field, "position");
  EXPECT_NE(none.cause.find("no fingerprints"), std::string::npos) << none.cause;
  EXPECT_EQ(house.sessions.find_tracked("phone-nobody"), nullptr);
}

}  // namespace
}  // namespace wayfuse
