#include <gtest/gtest.h>

#include <cmath>

#include "server/quality/walk_quality.hpp"

namespace wayfuse {
namespace {

PhoneTime at_s(int second) {
  return PhoneTime(std::chrono::seconds(second));
}

// Says where the newest scan was sent from: x = its first level. Radius 2 m.
class EchoTracker final : public Tracker {
 public:
  void feed(const MotionReport&) override {}
  void feed(const RssScan& scan) override { x_m_ = scan.readings.front().rss_dbm; }
  void feed(const GnssFix&) override {}
  std::optional<FusedPosition> position(PhoneTime) const override {
    if (!x_m_) return std::nullopt;
    FusedPosition position;
    position.place = {{-*x_m_, 0}, {0}};
    position.radius68_m = 2;
    position.radius95_m = 4;
    return position;
  }
  Fault why_no_fix() const override { return {FaultCode::kNoKnownAccessPoint, "", ""}; }
  std::unique_ptr<Tracker> clone() const override { return std::make_unique<EchoTracker>(*this); }

 private:
  std::optional<double> x_m_;
};

class EchoFactory final : public TrackerFactory {
 public:
  std::unique_ptr<Tracker> make_tracker(Random, const std::optional<KnownStart>&) const override {
    return std::make_unique<EchoTracker>();
  }
  const PipelineSpec& spec() const override { return spec_; }

 private:
  PipelineSpec spec_;
};

RssScan scan_saying(int second, double x_m) {
  return {at_s(second), {{Bssid{1}, -x_m, Duration{0}, 0, std::nullopt, std::nullopt}}};
}

// A walk along x at 1 m/s over ten seconds, in two parts that arrive in the wrong order within themselves.
std::vector<SurveyWalk> two_parts() {
  SurveyWalk first, second;
  first.marks = {{at_s(0), {{0, 0}, {0}}, 0.0}};
  first.scans = {scan_saying(4, 7)};
  second.part = 1;
  second.marks = {{at_s(10), {{10, 0}, {0}}, 0.0}};
  second.scans = {scan_saying(8, 8), scan_saying(6, 9)};
  return {first, second};
}

TEST(WalkQuality, TruthLiesBetweenTheMarks) {
  const RecordedTrack track = track_of(two_parts());
  EXPECT_DOUBLE_EQ(truth_at(track.marks, at_s(4))->point.x_m, 4.0);
  EXPECT_FALSE(truth_at(track.marks, at_s(11)));
  const std::vector<WayPoint> stairs = {{at_s(0), {{0, 0}, {0}}, 0.0}, {at_s(2), {{0, 0}, {1}}, 0.0}};
  EXPECT_FALSE(truth_at(stairs, at_s(1)));
}

TEST(WalkQuality, CountsErrorsCirclesAndSilence) {
  // Asked at 0 (no answer yet), 4 (says 7: 3 m off), 6 (9: 3 m off), 8 (8: right), 10 (8: 2 m off).
  const TrackQuality quality = check_walk(EchoFactory(), track_of(two_parts()), Random(1));
  EXPECT_EQ(quality.asked, 5u);
  EXPECT_EQ(quality.error_m.n, 4u);
  EXPECT_DOUBLE_EQ(quality.error_m.mean, 2.0);
  EXPECT_DOUBLE_EQ(quality.floor_hit, 1.0);
  EXPECT_DOUBLE_EQ(quality.in68, 0.5);
  EXPECT_DOUBLE_EQ(quality.in95, 1.0);
}

TEST(WalkQuality, LaterEvidenceNeverChangesAnEarlierAnswer) {
  const std::vector<PhoneTime> times = {at_s(5), at_s(7)};
  const auto whole = replay(EchoFactory(), track_of(two_parts()), times, Random(1));
  const auto cut = replay(EchoFactory(), track_of(std::vector<SurveyWalk>{two_parts()[0]}), times, Random(1));
  EXPECT_EQ(whole[0].position, cut[0].position);
  EXPECT_NE(whole[1].position, cut[1].position);
}

}  // namespace
}  // namespace wayfuse
