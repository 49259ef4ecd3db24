#include "server/buildings/building_keeper.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/buildings/stored_hall.hpp"

namespace wayfuse {
namespace {

using ::testing::HasSubstr;

class KeptBuilding : public StoredHall {
 protected:
  KeptBuilding() : StoredHall("nn", PublicationPolicy::kAutomatic) {
    settings.judge = [this](const Building& candidate, const Building* live, const std::vector<StoredQualityWalk>& walks) {
      ++judged;
      EXPECT_NE(live, nullptr);
      EXPECT_FALSE(walks.empty());
      MapJudgement judgement{publish, publish ? "same" : "worse", {}};
      MapQuality quality;
      quality.version = candidate.map_version();
      quality.walk_id = walks.front().record.id;
      quality.asked = quality.instants = 3;
      judgement.qualities = {quality};
      return judgement;
    };
    keep();
  }
  void keep() {
    keeper = std::make_unique<BuildingKeeper>(*store, shelf, run_inline, settings);
  }

  void survey(const std::string& key, std::size_t points) {
    SurveyBatch batch{key, hall().survey(1)};
    batch.points.resize(points);
    upload(batch);
    keeper->refresh(id);
  }
  void add_walk() {
    on_database([](BuildingDatabase& database) { EXPECT_TRUE(database.add_quality_walk({"round", "Plan", {}, "recording"})); });
  }
  std::uint64_t live() const { return shelf.find(id)->map_version(); }
  std::size_t points() const { return shelf.find(id)->site()->survey.size(); }
  std::vector<Publication> publications() {
    std::vector<Publication> found;
    on_database([&](BuildingDatabase& database) { found = database.publications().value(); });
    return found;
  }
  void roll_back() {
    on_database([](BuildingDatabase& database) { EXPECT_TRUE(database.roll_back({})); });
    keeper->refresh(id);
  }

  BuildingKeeper::Settings settings;
  std::unique_ptr<BuildingKeeper> keeper;
  bool publish = true;
  int judged = 0;
};

TEST_F(KeptBuilding, TheFirstSurveyWorksAtOnceWithoutCeremony) {
  keeper->refresh(id);
  EXPECT_EQ(live(), 0u) << "nothing surveyed, no map";
  survey("a", 5);
  EXPECT_EQ(live(), 1u);
  EXPECT_EQ(points(), 5u);
  ASSERT_EQ(publications().size(), 1u);
  EXPECT_EQ(publications()[0].by_key, 0u);
  EXPECT_THAT(publications()[0].reason, HasSubstr("survey version 1"));
}

TEST_F(KeptBuilding, WhoMadeItIsToldWhenItIsServed) {
  std::vector<std::function<void()>> later;
  keeper = std::make_unique<BuildingKeeper>(*store, shelf, [&](std::function<void()> task) { later.push_back(std::move(task)); }, settings);
  std::vector<std::string> told;
  const auto tell = [&](const char* what) {
    return [&told, what, this] { told.push_back(what + std::string(shelf.find(id) ? ", served" : ", not served")); };
  };
  const auto run_next = [&later] {
    const auto task = std::move(later.front());
    later.erase(later.begin());
    task();
  };
  keeper->refresh(id, tell("first"));
  keeper->refresh(id, tell("second"));   // what the first round read may be older than this call
  EXPECT_THAT(told, testing::IsEmpty());
  run_next();
  EXPECT_THAT(told, testing::ElementsAre("first, served"));
  run_next();
  EXPECT_THAT(told, testing::ElementsAre("first, served", "second, served"));
  EXPECT_THAT(later, testing::SizeIs(0));
  keeper->stop();
  keeper->refresh(id, tell("late"));
  EXPECT_EQ(told.back(), "late, served");
}

TEST_F(KeptBuilding, TheSameSurveyIsTheSameVersionWithTheSameHash) {
  survey("a", 5);
  RadioMapRecord first;
  on_database([&](BuildingDatabase& database) { first = database.maps().value().at(0); });
  keeper->refresh(id);
  on_database([&](BuildingDatabase& database) {
    EXPECT_EQ(database.maps()->size(), 1u);
    const auto again = MapVersions(database).stage(UnixTime(std::chrono::seconds(99)));
    EXPECT_EQ(again->version, first.version);
    EXPECT_EQ(again->sha256, first.sha256);
    const auto manifest = parse_manifest(database.map_content(first.version).value());
    EXPECT_EQ(manifest->points, 5u);
    EXPECT_EQ(to_content(*manifest), database.map_content(first.version).value());
  });
}

TEST_F(KeptBuilding, AVersionSaysHowLoudItsPhonesHearAndIsMadeFromOneLevel) {
  const auto survey_by = [&](const std::string& model, double louder_db, std::size_t scans) {
    SurveyBatch batch{model, hall().survey(static_cast<int>(scans))};
    for (ReferencePoint& point : batch.points) {
      point.device_model = model;
      for (RssScan& scan : point.scans) {
        for (ScanReading& reading : scan.readings) reading.rss_dbm = std::round(reading.rss_dbm) + louder_db;
      }
    }
    upload(batch);
  };
  survey_by("Alpha", 0.0, 2);
  survey_by("Beta", 6.0, 2);
  keeper->refresh(id);
  on_database([&](BuildingDatabase& database) {
    const std::string recipe = database.maps()->back().recipe;
    EXPECT_THAT(recipe, HasSubstr(R"("model":"Beta")"));
    EXPECT_THAT(recipe, HasSubstr(R"("standing":"learnt")"));
  });
  // The level of both is the first one's: where they stood together they say the same within what neighbours differ by.
  std::map<std::string, double> sum_dbm;
  for (const ReferencePoint& point : shelf.find(id)->site()->survey) {
    for (const RssScan& scan : point.scans) {
      for (const ScanReading& reading : scan.readings) sum_dbm[point.device_model] += reading.rss_dbm / 1000.0;
    }
  }
  EXPECT_NEAR(sum_dbm["Alpha"], sum_dbm["Beta"], 0.02 * std::abs(sum_dbm["Alpha"]));
}

TEST_F(KeptBuilding, AWorseMapIsHeldBackAndAnotherOneTriedWithTheNextSurvey) {
  survey("a", 5);
  add_walk();
  publish = false;
  survey("b", 6);
  EXPECT_EQ(judged, 1);
  EXPECT_EQ(live(), 1u);
  EXPECT_EQ(points(), 5u) << "the live version's survey, not today's";
  keeper->refresh(id);
  EXPECT_EQ(judged, 1) << "what was judged is not judged again";
  publish = true;
  survey("c", 7);
  EXPECT_EQ(judged, 2);
  EXPECT_EQ(live(), 3u);
  EXPECT_EQ(points(), 18u);
  EXPECT_THAT(publications().back().reason, HasSubstr("same"));
}

TEST_F(KeptBuilding, ARollbackHoldsUntilSomebodyPromotes) {
  survey("a", 5);
  survey("b", 6);
  EXPECT_EQ(live(), 2u);
  roll_back();
  EXPECT_EQ(live(), 1u);
  survey("c", 7);
  EXPECT_EQ(live(), 1u) << "new surveys wait: an operator has spoken";
  on_database([](BuildingDatabase& database) {
    const auto staged = MapVersions(database).stage({});
    Publication publication;
    publication.version = staged->version;
    publication.by_key = 5;
    EXPECT_TRUE(database.promote(publication, 1));
  });
  keeper->refresh(id);
  EXPECT_EQ(points(), 18u);
  survey("d", 8);
  EXPECT_EQ(points(), 26u) << "and by itself again";
}

TEST_F(KeptBuilding, AnOlderVersionPromotedByHandHoldsToo) {
  survey("a", 5);
  survey("b", 6);
  on_database([](BuildingDatabase& database) {
    Publication publication;
    publication.version = 1;
    publication.by_key = 5;
    EXPECT_TRUE(database.promote(publication, 2));
  });
  keeper->refresh(id);
  EXPECT_EQ(live(), 1u) << "not promoted over by what was live before";
  survey("c", 7);
  EXPECT_EQ(live(), 1u);
}

TEST_F(KeptBuilding, AReviewedBuildingWaitsForItsOperator) {
  change([](BuildingRecord& record) { record.publication = PublicationPolicy::kReviewed; });
  survey("a", 5);
  EXPECT_EQ(live(), 0u);
  EXPECT_TRUE(publications().empty());
}

TEST_F(KeptBuilding, DistrustedTransmittersAreLeftOutOfAVersionOfTheirOwn) {
  survey("a", 33);
  const Bssid a{0x1000u + 'A'};
  on_database([&](BuildingDatabase& database) { EXPECT_TRUE(database.set_trust(a, AccessPointTrust::kNever, {})); });
  keeper->refresh(id);
  EXPECT_EQ(live(), 2u);
  const auto building = shelf.find(id);
  ASSERT_EQ(building->distrusted().size(), 1u);
  for (const ReferencePoint& point : building->site()->survey) {
    for (const ScanReading& reading : point.scans.at(0).readings) EXPECT_NE(reading.bssid, a);
  }
  EXPECT_TRUE(building->levels()->knows(a)) << "it is still watched";
  // A scan in which only the distrusted one shouts from elsewhere: the position does not follow it.
  const auto tracker = (*building->pipeline(""))->make_tracker(Random(1), {});
  RssScan scan = hall().scan_at({40, 0}, PhoneTime(std::chrono::seconds(1)));
  std::erase_if(scan.readings, [&](const ScanReading& reading) { return reading.bssid == a; });
  scan.readings.push_back({a, -30.0, Duration{0}, 2412, {}, {}});
  tracker->feed(scan);
  EXPECT_NEAR(tracker->position(scan.time)->place.point.x_m, 40.0, 0.1);
  on_database([&](BuildingDatabase& database) { EXPECT_TRUE(database.set_trust(a, AccessPointTrust::kAlways, {})); });
  keeper->refresh(id);
  EXPECT_EQ(live(), 1u) << "trusted again it is the very map it was";
}

TEST_F(KeptBuilding, ErasedPointsAreGoneFromEveryVersionAndItSaysSo) {
  survey("a", 5);
  change([](BuildingRecord& record) { record.publication = PublicationPolicy::kReviewed; });
  on_database([](BuildingDatabase& database) { EXPECT_EQ(database.erase({.point_id = 1}).value(), 1u); });
  keeper->refresh(id);
  EXPECT_EQ(live(), 1u);
  EXPECT_EQ(points(), 4u);
  EXPECT_FALSE(shelf.find(id)->map_is_whole());
}

TEST_F(KeptBuilding, ManyBatchesAtOnceMakeFewVersions) {
  ServerTime now{};
  settings.least_between = std::chrono::seconds(2);
  settings.now = [&] { return now; };
  keep();
  for (int i = 0; i < 20; ++i) survey("b" + std::to_string(i), 1);
  EXPECT_EQ(points(), 1u) << "the first at once";
  keeper->refresh(id);
  EXPECT_EQ(points(), 1u);
  now += std::chrono::seconds(2);
  keeper->tick();
  EXPECT_EQ(points(), 20u) << "the others together";
  on_database([](BuildingDatabase& database) { EXPECT_EQ(database.maps()->size(), 2u); });
  survey("late", 1);
  EXPECT_EQ(points(), 20u);
  keeper->refresh(id, [] {});
  EXPECT_EQ(points(), 21u) << "an operator's word does not wait";
}

}  // namespace
}  // namespace wayfuse
