#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "wayfuse/proto/codec.hpp"
#include "wayfuse/sdk/surveyor.hpp"

namespace wayfuse {
namespace {

using namespace std::chrono_literals;

RssScan scan_at(Duration time, std::vector<std::pair<std::uint64_t, Duration>> heard) {
  RssScan scan{PhoneTime{time}, {}};
  for (const auto& [bssid, age] : heard) scan.readings.push_back({Bssid{bssid}, -60, age, 2412, {}, {}});
  return scan;
}

Place at(double x, double y, int floor = 0) { return {{x, y}, {floor}}; }

std::vector<ReferencePoint> all_points(Surveyor& surveyor) {
  std::vector<ReferencePoint> points;
  for (auto& batch : surveyor.take_batches()) {
    for (auto& point : batch.points) points.push_back(std::move(point));
  }
  return points;
}

//  10 s          20 s
//   A ----5 m---- B      scan at 18 s: one reading fresh, one 4 s old, one 9 s old (heard before A)
TEST(Surveyor, PlacesEveryReadingWhereTheWalkerWasWhenItWasHeard) {
  Surveyor surveyor("m", Random(1));
  ASSERT_TRUE(surveyor.begin_walk("w"));
  ASSERT_TRUE(surveyor.mark(PhoneTime{10s}, at(0, 0), 0.3));
  ASSERT_TRUE(surveyor.scan(scan_at(18s, {{1, 0s}, {2, 4s}, {3, 9s}}), UnixTime{1000s}));
  ASSERT_TRUE(surveyor.mark(PhoneTime{20s}, at(5, 0), 0.5));
  ASSERT_TRUE(surveyor.end_walk());
  const auto points = all_points(surveyor);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NEAR(points[0].place.point.x_m, 4, 1e-9);  // 8/10 of the way
  EXPECT_EQ(points[0].scans[0].time, PhoneTime{18s});
  EXPECT_EQ(points[0].scans[0].readings[0].bssid, Bssid{1});
  EXPECT_NEAR(points[1].place.point.x_m, 2, 1e-9);  // 4/10
  EXPECT_EQ(points[1].scans[0].time, PhoneTime{14s});
  EXPECT_EQ(points[1].scans[0].readings[0].age, 0s);
  EXPECT_EQ(points[1].surveyed_at, UnixTime{996s});
  EXPECT_EQ(points[1].walk, "w");
  EXPECT_DOUBLE_EQ(points[1].sigma_m, 0.5);
  EXPECT_EQ(surveyor.readings_left_out(), 1u);
}

TEST(Surveyor, KeepsTheYoungestOfAListLongerThanAMessage) {
  RssScan crowded{PhoneTime{5s}, {}};
  for (std::uint64_t i = 0; i < 600; ++i) crowded.readings.push_back({Bssid{i + 1}, -60, i % 2 == 0 ? 900ms : 100ms, 2412, {}, {}});
  Surveyor surveyor("model", Random(1));
  ASSERT_TRUE(surveyor.begin_walk("dense"));
  ASSERT_TRUE(surveyor.mark(PhoneTime{0s}, at(0, 0), 0.5));
  ASSERT_TRUE(surveyor.scan(crowded, UnixTime{0s}));
  ASSERT_TRUE(surveyor.mark(PhoneTime{10s}, at(10, 0), 0.5));
  ASSERT_TRUE(surveyor.end_walk());
  ASSERT_TRUE(surveyor.add_point(at(0, 0), 0.5, {crowded}, UnixTime{0s}));
  EXPECT_EQ(surveyor.readings_left_out(), 2u * 88);
  std::set<std::uint64_t> young, kept;
  for (std::uint64_t i = 1; i < 600; i += 2) young.insert(i + 1);
  for (const ReferencePoint& point : all_points(surveyor)) {
    for (const RssScan& scan : point.scans) {
      for (const ScanReading& reading : scan.readings) kept.insert(reading.bssid.value);
    }
  }
  EXPECT_EQ(kept.size(), 512u);
  EXPECT_TRUE(std::ranges::includes(kept, young));
}

TEST(Surveyor, KeepsReadingsHeardTogetherTogether) {
  Surveyor surveyor("m", Random(1));
  ASSERT_TRUE(surveyor.begin_walk("w"));
  ASSERT_TRUE(surveyor.mark(PhoneTime{0s}, at(0, 0), 0));
  ASSERT_TRUE(surveyor.mark(PhoneTime{10s}, at(10, 0), 0));
  ASSERT_TRUE(surveyor.scan(scan_at(5s, {{1, 100ms}, {2, 0ms}, {3, 200ms}}), UnixTime{0s}));
  ASSERT_TRUE(surveyor.end_walk());
  const auto points = all_points(surveyor);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].place.point.x_m, 4.9, 1e-9);
  ASSERT_EQ(points[0].scans[0].readings.size(), 3u);
  EXPECT_EQ(points[0].scans[0].readings[2].age, 200ms);
}

TEST(Surveyor, TakesWhatTheCacheRepeatsOnce) {
  Surveyor surveyor("m", Random(1));
  ASSERT_TRUE(surveyor.begin_walk("w"));
  ASSERT_TRUE(surveyor.mark(PhoneTime{0s}, at(0, 0), 0));
  ASSERT_TRUE(surveyor.mark(PhoneTime{10s}, at(10, 0), 0));
  ASSERT_TRUE(surveyor.scan(scan_at(5s, {{1, 0s}, {2, 1s}}), UnixTime{0s}));
  ASSERT_TRUE(surveyor.scan(scan_at(8s, {{1, 3s}, {2, 0s}}), UnixTime{0s}));  // 1 is the reading of second 5 again
  ASSERT_TRUE(surveyor.end_walk());
  const auto points = all_points(surveyor);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].scans[0].readings.size(), 2u);
  ASSERT_EQ(points[1].scans[0].readings.size(), 1u);
  EXPECT_EQ(points[1].scans[0].readings[0].bssid, Bssid{2});
  EXPECT_EQ(surveyor.readings_left_out(), 0u);
}

TEST(Surveyor, LeavesOutWhatWasHeardOnTheStairs) {
  Surveyor surveyor("m", Random(1));
  ASSERT_TRUE(surveyor.begin_walk("w"));
  ASSERT_TRUE(surveyor.mark(PhoneTime{0s}, at(0, 0, 0), 0));
  ASSERT_TRUE(surveyor.mark(PhoneTime{10s}, at(0, 5, 1), 0));
  ASSERT_TRUE(surveyor.mark(PhoneTime{20s}, at(10, 5, 1), 0));
  ASSERT_TRUE(surveyor.scan(scan_at(5s, {{1, 0s}}), UnixTime{0s}));
  ASSERT_TRUE(surveyor.scan(scan_at(15s, {{1, 0s}}), UnixTime{0s}));
  ASSERT_TRUE(surveyor.end_walk());
  const auto points = all_points(surveyor);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].place, at(5, 5, 1));
  EXPECT_EQ(surveyor.readings_left_out(), 1u);
}

TEST(Surveyor, CutsBatchesWithinEveryLimitAndLosesNothing) {
  Surveyor surveyor("a model with a name", Random(1));
  std::size_t readings = 0;
  for (int i = 0; i < 700; ++i) {
    std::vector<RssScan> scans;
    for (int s = 0; s < (i == 350 ? 64 : 1 + i % 3); ++s) {
      RssScan scan{PhoneTime{std::chrono::seconds(i)}, {}};
      for (std::uint64_t ap = 1; ap <= (i == 350 ? 40u : 1u + static_cast<unsigned>(i) % 20); ++ap) {
        scan.readings.push_back({Bssid{0xa0b0c0d0e000 + ap}, -55.5, 1234567us, 5180, {}, {}});
        ++readings;
      }
      scans.push_back(std::move(scan));
    }
    ASSERT_TRUE(surveyor.add_point(at(i, 1), 0.5, std::move(scans), UnixTime{1s}));
  }
  std::set<std::string> keys;
  std::size_t seen = 0;
  for (const SurveyBatch& batch : surveyor.take_batches()) {
    EXPECT_TRUE(check(ClientMessage(batch)));
    EXPECT_LE(encode(ClientMessage(batch), Encoding::kJson).size(), Limits::kMessageBytes);
    keys.insert(batch.idempotency_key);
    for (const auto& point : batch.points) {
      for (const auto& scan : point.scans) seen += scan.readings.size();
    }
  }
  EXPECT_EQ(seen, readings);
  EXPECT_GT(keys.size(), 4u);
  EXPECT_TRUE(surveyor.take_batches().empty());
}

TEST(Surveyor, SaysWhatWasAskedInTheWrongOrder) {
  Surveyor surveyor("m", Random(1));
  EXPECT_FALSE(surveyor.mark(PhoneTime{1s}, at(0, 0), 0));
  EXPECT_FALSE(surveyor.scan(scan_at(1s, {{1, 0s}}), UnixTime{0s}));
  EXPECT_FALSE(surveyor.end_walk());
  EXPECT_FALSE(surveyor.begin_walk(""));
  ASSERT_TRUE(surveyor.begin_walk("w"));
  EXPECT_FALSE(surveyor.begin_walk("v"));
  ASSERT_TRUE(surveyor.mark(PhoneTime{2s}, at(0, 0), 0));
  EXPECT_EQ(surveyor.mark(PhoneTime{2s}, at(0, 0), 0).fault().field, "mark.time");
  EXPECT_FALSE(surveyor.mark(PhoneTime{3s}, at(std::nan(""), 0), 0));
  EXPECT_FALSE(surveyor.end_walk());  // one mark only
  EXPECT_FALSE(surveyor.add_point(at(0, 0), 0.5, {}, UnixTime{0s}));
}

// An hour of walking: every part fits a message, nothing is lost, and the parts follow each other in time.
TEST(Surveyor, HandsAWalkOverAsRecordedInPartsThatFit) {
  Surveyor surveyor("m", Random(1));
  EXPECT_FALSE(surveyor.motion({}));
  ASSERT_TRUE(surveyor.begin_walk("w"));
  ASSERT_TRUE(surveyor.mark(PhoneTime{0s}, at(0, 0), 0.3));
  MotionReport step;
  step.interval = 500ms;
  step.steps = 1;
  step.step_length_m = 0.7;
  for (int i = 1; i <= 3000; ++i) {
    step.time = PhoneTime{500ms * i};
    ASSERT_TRUE(surveyor.motion(step));
    if (i % 6 == 0) {
      ASSERT_TRUE(surveyor.scan(scan_at(500ms * i, {{1, 0s}, {2, 1s}, {3, 2s}}), UnixTime{0s}));
    }
    if (i % 60 == 0) {
      ASSERT_TRUE(surveyor.mark(step.time + 1ms, at(i, 0), 0.3));
    }
  }
  const auto parts = surveyor.end_recorded_walk(PhoneTime{0s}, UnixTime{1000s});
  ASSERT_TRUE(parts);
  ASSERT_GT(parts->size(), 3u);
  std::set<std::string> keys;
  std::size_t marks = 0, motion = 0, scans = 0;
  PhoneTime newest{-1s};
  for (std::size_t i = 0; i < parts->size(); ++i) {
    const SurveyWalk& part = parts->at(i);
    EXPECT_TRUE(check(ClientMessage(part)));
    EXPECT_LE(encode(ClientMessage(part), Encoding::kJson).size(), Limits::kMessageBytes);
    EXPECT_EQ(part.part, i);
    EXPECT_EQ(part.last, i + 1 == parts->size());
    EXPECT_EQ(part.walk, "w");
    keys.insert(part.idempotency_key);
    marks += part.marks.size(), motion += part.motion.size(), scans += part.scans.size();
    for (const MotionReport& report : part.motion) EXPECT_GT(report.time, newest), newest = report.time;
  }
  EXPECT_EQ(keys.size(), parts->size());
  EXPECT_EQ(marks, 51u);
  EXPECT_EQ(motion, 3000u);
  EXPECT_EQ(scans, 500u);
  EXPECT_FALSE(surveyor.end_walk()) << "it has ended";
}

}  // namespace
}  // namespace wayfuse
