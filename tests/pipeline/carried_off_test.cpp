#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "server/pipeline/field_tracker.hpp"

namespace wayfuse {
namespace {

constexpr BuildingPoint kHere{0.0, 0.0}, kThere{80.0, 0.0};

/// What scans say follows a script: heard by a phone here on the ground floor, or carried off to another floor.
class Scripted final : public Locator {
 public:
  std::unique_ptr<Locator> clone() const override { return std::make_unique<Scripted>(*this); }
  /// The only reading's level says what to play: -50 here, -60 carried off, -70 too, but the floors are taken for one another,
  /// -80 carried off to where the survey about the track resembles the scan as well, -90 to where it does not at all, which speaks so clearly
  /// that one scan is enough; -95 so does, and leaves no doubt of the floor.
  std::optional<Fix> locate(const RssScan& scan) override {
    level_dbm_ = scan.readings[0].rss_dbm;
    const bool above_first = level_dbm_ == -60.0 || level_dbm_ <= -80.0;
    const double first = level_dbm_ == -95.0 ? 1.0 - 1e-6 : 0.6;
    votes_ = {{{FloorOrdinal{above_first ? 1 : 0}, first}, {FloorOrdinal{above_first ? 0 : 1}, 1.0 - first}}};
    return Fix{{point(), FloorOrdinal{away() ? 1 : 0}}, 3.0, 10};
  }
  std::span<const FloorProbability> floors() const override { return votes_; }
  int transmitters_known() const override { return 10; }
  int transmitters_unknown() const override { return 0; }
  bool has_likelihood() const override { return true; }
  void add_log_likelihood(std::span<const float> x_m, std::span<const float> y_m, FloorOrdinal floor, std::span<float> out) const override {
    for (std::size_t i = 0; i < x_m.size(); ++i) {
      const double off_m = std::hypot(static_cast<double>(x_m[i]) - point().x_m, static_cast<double>(y_m[i]) - point().y_m);
      out[i] -= floor == FloorOrdinal{away() ? 1 : 0} ? static_cast<float>(std::min(least(), off_m * off_m / 18.0)) : static_cast<float>(least());
    }
  }
  bool draw(FloorOrdinal, Random& random, std::span<float> x_m, std::span<float> y_m) override {
    for (std::size_t i = 0; i < x_m.size(); ++i) {
      x_m[i] = static_cast<float>(point().x_m + 3.0 * random.normal());
      y_m[i] = static_cast<float>(point().y_m + 3.0 * random.normal());
    }
    return true;
  }
  std::optional<double> misfit(FloorOrdinal, BuildingPoint at) const override {
    if (level_dbm_ == -80.0) return 0.0;
    if (distance_m(at, point()) <= 25.0) return -0.3;
    return level_dbm_ <= -90.0 ? 0.5 : 0.1;
  }

 private:
  bool away() const { return level_dbm_ != -50.0; }
  double least() const { return level_dbm_ <= -90.0 ? 20.0 : 11.5; }  // log-likelihood a place loses at most
  BuildingPoint point() const { return away() ? kThere : kHere; }
  double level_dbm_ = -50.0;
  std::array<FloorProbability, 2> votes_{};
};

class ScriptedModel final : public LocatorModel {
 public:
  std::unique_ptr<Locator> make() const override { return std::make_unique<Scripted>(); }
};

class CarriedOff : public testing::Test {
 protected:
  CarriedOff() { begin({}); }
  void begin(const WalkerSettings& settings, std::uint64_t seed = 3) {
    auto parts = std::make_shared<FieldTrackerParts>();
    parts->site = std::make_shared<Site>();
    parts->locator = std::make_shared<ScriptedModel>();
    parts->settings = settings;
    tracker_ = std::make_unique<FieldTracker>(parts, Random(seed), std::nullopt);
  }
  Place hear(double level_dbm) { return track(level_dbm).place; }
  FusedPosition track(double level_dbm) {
    MotionReport motion;
    motion.time = PhoneTime(from_seconds(time_s_ += 2.0));
    motion.interval = from_seconds(2.0);
    motion.steps = 1;
    motion.step_length_m = 0.1;
    tracker_->feed(motion);
    tracker_->feed(RssScan{motion.time, {{Bssid{1}, level_dbm, Duration{0}, 2437, {}, {}}}});
    return *tracker_->position(motion.time);
  }
  std::unique_ptr<FieldTracker> tracker_;
  double time_s_ = 0.0;
};

TEST_F(CarriedOff, TheTrackGoesOnOnTheFloorOfTheCloudThatWonWhateverTheNewestScanVotesFor) {
  for (int i = 0; i < 10; ++i) hear(-50.0);
  Place place = hear(-60.0);
  ASSERT_LT(distance_m(place.point, kHere), 10.0) << "one scan takes no track away";
  for (int i = 0; i < 8 && distance_m(place.point, kThere) > 20.0; ++i) place = hear(-70.0);
  EXPECT_LT(distance_m(place.point, kThere), 10.0);
  EXPECT_EQ(place.floor, FloorOrdinal{1});
}

TEST_F(CarriedOff, PlacesThatForetellTheScanFarBetterAreHeardThoughTheSurveyAboutTheTrackResemblesIt) {
  for (int i = 0; i < 10; ++i) hear(-50.0);
  Place place;
  for (int i = 0; i < 3; ++i) place = hear(-80.0);
  EXPECT_LT(distance_m(place.point, kThere), 10.0);
}

TEST_F(CarriedOff, OneScanThatOnlyAnotherPlaceForetellsMovesTheTrackAndIsSuspect) {
  for (int i = 0; i < 10; ++i) ASSERT_EQ(track(-50.0).integrity, Integrity::kOk);
  const FusedPosition position = track(-90.0);
  EXPECT_LT(distance_m(position.place.point, kThere), 5.0);
  EXPECT_EQ(position.place.floor, FloorOrdinal{1});
  EXPECT_EQ(position.integrity, Integrity::kSuspect) << "it may be somebody's trick";
}

// Walkers drawn from a scan foretell it, which accuses nobody: none are before it is asked what the track foretells.
TEST_F(CarriedOff, ToAnotherFloorForCertainItIsSuspectAtOnceAndLeavesNobodyBehind) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    begin({}, seed);
    for (int i = 0; i < 10; ++i) ASSERT_EQ(track(-50.0).integrity, Integrity::kOk);
    const FusedPosition position = track(-95.0);
    EXPECT_EQ(position.place.floor, FloorOrdinal{1}) << seed;
    EXPECT_EQ(position.integrity, Integrity::kSuspect) << seed;
    EXPECT_LT(distance_m(position.place.point, kThere), 2.0) << seed;
    EXPECT_LT(position.radius68_m, 8.0) << seed;
  }
}

TEST_F(CarriedOff, ATrackThatHadNoStandingMovesAndAccusesNobody) {
  hear(-50.0);
  hear(-50.0);
  const FusedPosition position = track(-90.0);
  EXPECT_LT(distance_m(position.place.point, kThere), 5.0);
  EXPECT_NE(position.integrity, Integrity::kSuspect);
}

TEST_F(CarriedOff, NobodyStaysBehindToPullThePositionBetweenTwoPlaces) {
  for (int i = 0; i < 10; ++i) hear(-50.0);
  hear(-90.0);
  const FusedPosition position = track(-90.0);
  EXPECT_LT(distance_m(position.place.point, kThere), 5.0);
  EXPECT_EQ(position.place.floor, FloorOrdinal{1});
  EXPECT_LT(position.radius68_m, 8.0);
}

TEST_F(CarriedOff, WhoWasGivenUpIsHeardOnAndComesBack) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {  // within four scans
    begin({}, seed);
    for (int i = 0; i < 10; ++i) hear(-50.0);
    ASSERT_LT(distance_m(hear(-90.0).point, kThere), 5.0) << seed;
    for (int i = 0; i < 3; ++i) hear(-50.0);
    const Place place = hear(-50.0);
    EXPECT_LT(distance_m(place.point, kHere), 10.0) << seed;
    EXPECT_EQ(place.floor, FloorOrdinal{0}) << seed;
  }
}

TEST_F(CarriedOff, WithoutSecondOpinionsTheTrackBeginsAnewJustSo) {
  begin({.second_opinion = false});
  for (int i = 0; i < 10; ++i) hear(-50.0);
  hear(-90.0);
  EXPECT_LT(distance_m(hear(-90.0).point, kThere), 5.0);
}

}  // namespace
}  // namespace wayfuse
