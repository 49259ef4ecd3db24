#include "server/maps/map_desk.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "server/quality/map_gate.hpp"
#include "tests/buildings/stored_hall.hpp"
#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

class Desk : public StoredHall {
 protected:
  Desk() : StoredHall("wknn", PublicationPolicy::kReviewed) {
    const auto now = [this] { return UnixTime(std::chrono::seconds(++second)); };
    keeper = std::make_unique<BuildingKeeper>(*store, shelf, run_inline, BuildingKeeper::Settings{});
    points = std::make_unique<AccessPointDesk>(*store, shelf, now, [this](BuildingId building) { keeper->refresh(building); });
    desk = std::make_unique<MapDesk>(*store, shelf, *keeper, *points, run_inline, now);
  }
  /// A survey; `shifted_m` puts every point that far east of where it was.
  void survey(const std::string& key, double shifted_m = 0.0) {
    SurveyBatch batch{key, hall().survey(1)};
    for (ReferencePoint& point : batch.points) point.place.point.x_m += shifted_m;
    upload(batch);
  }
  /// A walk along the middle row with marks at both ends, 1 m a second.
  void add_quality_walk() {
    SurveyWalk walk;
    walk.idempotency_key = walk.walk = "truth";
    walk.marks = {{time(0), {{0, 4}, {0}}, 0.0}, {time(40), {{40, 4}, {0}}, 0.0}};
    for (int s = 2; s < 40; s += 2) walk.scans.push_back(hall().scan_at({static_cast<double>(s), 4}, time(s)));
    on_database([&](BuildingDatabase& database) {
      EXPECT_TRUE(database.add_quality_walk({"middle", "Plan", {}, encode(ClientMessage(walk), Encoding::kJson)}));
    });
  }
  static PhoneTime time(int second) { return PhoneTime(std::chrono::seconds(second)); }

  template <typename T>
  static MapControl::Done<T> into(std::optional<Result<T>>& answer) {
    return [&answer](Result<T> found) { answer.emplace(std::move(found)); };
  }
  std::uint64_t build() {
    std::optional<Result<std::uint64_t>> version;
    desk->build_map(id, into(version));
    EXPECT_TRUE(*version) << to_string(version->fault());
    return version->value();
  }
  Result<MapPromoted> promote(MapPromotion promotion) {
    std::optional<Result<MapPromoted>> promoted;
    desk->promote_map(id, promotion, into(promoted));
    return *promoted;
  }

  std::unique_ptr<BuildingKeeper> keeper;
  std::unique_ptr<AccessPointDesk> points;
  std::unique_ptr<MapDesk> desk;
  int second = 0;
};

TEST_F(Desk, AWorseMapIsRefusedOverriddenAndRolledBackInOneCallEach) {
  add_quality_walk();
  survey("good");
  const std::uint64_t good = build();
  ASSERT_TRUE(promote({.version = good})->publication) << "nothing was live: nothing to be worse than";
  EXPECT_EQ(shelf.find(id)->map_version(), good);
  survey("poisoned", 15.0);
  const std::uint64_t poisoned = build();
  std::optional<Result<MapComparisonView>> comparison;
  desk->compare_map(id, poisoned, "", into(comparison));
  EXPECT_EQ((*comparison)->verdict, "worse");
  EXPECT_EQ((*comparison)->walks.at(0).name, "middle");
  EXPECT_GT((*comparison)->difference_m, 1.0);

  const auto refused = promote({.version = poisoned});
  EXPECT_FALSE(refused->publication);
  EXPECT_FALSE(refused->comparison.reasons.empty());
  EXPECT_EQ(shelf.find(id)->map_version(), good);
  EXPECT_EQ(promote({.version = poisoned, .expected_live = 77}).fault().field, "expected_live");
  MapPromotion forced{.version = poisoned, .override_gate = true, .by_key = 4, .reason = "trial"};
  ASSERT_TRUE(promote(forced)->publication);
  EXPECT_EQ(shelf.find(id)->map_version(), poisoned);
  EXPECT_EQ(promote(forced).fault().code, FaultCode::kConflict) << "live already";

  std::optional<Result<Publication>> back;
  desk->roll_back_map(id, 4, "was a trial", into(back));
  EXPECT_EQ((*back)->version, good);
  EXPECT_EQ(shelf.find(id)->map_version(), good);
  desk->roll_back_map(id, 4, "", into(back));
  EXPECT_EQ(back->fault().code, FaultCode::kConflict) << "nothing was live before";
}

TEST_F(Desk, FiguresAreMeasuredOnceAndAgainWhenThePipelineChanges) {
  add_quality_walk();
  survey("good");
  const std::uint64_t version = build();
  const auto measured_at = [&] {
    std::vector<MapQuality> found;
    on_database([&](BuildingDatabase& database) { found = database.qualities(version).value(); });
    EXPECT_EQ(found.size(), 1u);
    return found.at(0).measured_at;
  };
  const UnixTime first = measured_at();
  build();
  EXPECT_EQ(measured_at(), first) << "nothing to measure anew";
  change([](BuildingRecord& record) { record.pipeline = "nn"; });
  build();
  EXPECT_NE(measured_at(), first);
  std::optional<Result<MapComparisonView>> other;
  const UnixTime kept = measured_at();
  desk->compare_map(id, version, "p1", into(other));
  EXPECT_EQ((*other)->pipeline, "p1");
  EXPECT_EQ(measured_at(), kept) << "figures of another pipeline are not kept";
  desk->compare_map(id, version, "p77", into(other));
  EXPECT_EQ(other->fault().code, FaultCode::kUnknownName);
  desk->compare_map(id, 99, "", into(other));
  EXPECT_EQ(other->fault().code, FaultCode::kNotFound);
}

TEST_F(Desk, TheGateOfAutomaticMapsHoldsAPoisonedSurveyBack) {
  add_quality_walk();
  change([](BuildingRecord& record) { record.publication = PublicationPolicy::kAutomatic; });
  BuildingKeeper::Settings settings;
  settings.judge = [](const Building& candidate, const Building* live, const std::vector<StoredQualityWalk>& walks) {
    return judge_map(candidate, live, walks, {});
  };
  BuildingKeeper gated(*store, shelf, run_inline, settings);
  survey("good");
  gated.refresh(id);
  EXPECT_EQ(shelf.find(id)->map_version(), 1u);
  survey("poisoned", 15.0);
  gated.refresh(id);
  EXPECT_EQ(shelf.find(id)->map_version(), 1u) << "held back";
  survey("good again");
  survey("and again");
  survey("and once more");
  gated.refresh(id);
  EXPECT_EQ(shelf.find(id)->site()->survey.size(), shelf.find(id)->map_version() == 1u ? 33u : 165u);
}

TEST_F(Desk, PromisesAccuracyAndAPlanForTheLiveMap) {
  survey("good");
  ASSERT_TRUE(promote({.version = build()})->publication);
  std::optional<Result<ExpectedAccuracy>> accuracy;
  desk->expected_accuracy(id, {0}, into(accuracy));
  ASSERT_TRUE(*accuracy) << to_string(accuracy->fault());
  EXPECT_TRUE((*accuracy)->median_m);
  desk->expected_accuracy(id, {4}, into(accuracy));
  EXPECT_EQ(accuracy->fault().code, FaultCode::kNotFound);
  std::optional<Result<SurveyPlan>> plan;
  desk->survey_plan(id, {0}, into(plan));
  EXPECT_TRUE(*plan);
}

TEST_F(Desk, AnAccessPointThatFellSilentIsPutAsideAndSaysWhereToSurveyAgain) {
  change([](BuildingRecord& record) { record.publication = PublicationPolicy::kAutomatic; });
  survey("good");
  keeper->refresh(id);
  const Bssid gone{0x1000u + 'B'};
  for (std::uint64_t session = 1; session <= 6; ++session) {
    for (int x = 0; x <= 40; x += 4) {
      RssScan scan = hall().scan_at({static_cast<double>(x), 4}, time(x));
      std::erase_if(scan.readings, [&](const ScanReading& reading) { return reading.bssid == gone; });
      FusedPosition position;
      position.place = {{static_cast<double>(x), 4}, {0}};
      position.radius68_m = 2.0;
      points->hear(session, *shelf.find(id), scan, position);
    }
  }
  points->review();
  EXPECT_EQ(points->counts().vanished, 1u);
  EXPECT_EQ(points->counts().distrusted, 1u);
  EXPECT_EQ(shelf.find(id)->map_version(), 2u) << "a version without it is in force";
  ASSERT_EQ(shelf.find(id)->distrusted().size(), 1u);
  EXPECT_EQ(shelf.find(id)->distrusted()[0], gone);
  std::optional<Result<std::vector<AccessPointView>>> views;
  desk->access_points(id, into(views));
  const auto view = std::ranges::find(**views, gone, [](const AccessPointView& each) { return each.record.bssid; });
  ASSERT_NE(view, (*views)->end());
  EXPECT_EQ(view->record.state, AccessPointState::kVanished);
  ASSERT_FALSE(view->resurvey.empty());
  EXPECT_NEAR(view->resurvey[0].point.x_m, 20.0, 1e-9) << "where it hung";
  std::optional<Result<AccessPointView>> trusted;
  desk->trust_access_point(id, gone, AccessPointTrust::kAlways, into(trusted));
  EXPECT_FALSE((*trusted)->record.distrusted());
  EXPECT_TRUE(shelf.find(id)->distrusted().empty());
}

}  // namespace
}  // namespace wayfuse
