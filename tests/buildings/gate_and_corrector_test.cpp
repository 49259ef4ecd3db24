#include <gtest/gtest.h>

#include <cmath>

#include "server/buildings/building_keeper.hpp"
#include "tests/fixtures/scratch_folder.hpp"

namespace wayfuse {
namespace {

// A corridor of 60 m, a radio every 6 m, walks up and down it with a point every 2 s.
std::vector<ReferencePoint> corridor() {
  std::vector<ReferencePoint> survey;
  Random random(7);
  for (int walk = 0; walk < 6; ++walk) {
    for (int i = 0; i <= 24; ++i) {
      ReferencePoint point;
      point.place = {{walk % 2 ? 60.0 - 2.5 * i : 2.5 * i, 0.3 * walk}, FloorOrdinal{0}};
      point.walk = "w" + std::to_string(walk);
      point.device_model = "phone";
      RssScan scan{PhoneTime{from_seconds(2.0 * i)}, {}};
      for (int radio = 0; radio < 11; ++radio) {
        const double d_m = std::hypot(point.place.point.x_m - 6.0 * radio, point.place.point.y_m - (radio % 2 ? 4.0 : -4.0));
        const double level = std::round(-35.0 - 26.0 * std::log10(1.0 + d_m) + 2.0 * random.normal());
        scan.readings.push_back({Bssid{0x2000u + static_cast<unsigned>(radio)}, std::max(level, -95.0), Duration{0}, 2437, {}, {}});
      }
      point.scans = {scan};
      survey.push_back(std::move(point));
    }
  }
  return survey;
}

BuildingRecord record_for(const std::string& pipeline) {
  BuildingRecord record;
  record.id = BuildingId{1};
  record.name = "corridor";
  record.floors = {{FloorOrdinal{0}, "0", {}, {}}};
  record.pipeline = pipeline;
  return record;
}

TEST(BuildingGate, AMisplacedPointStaysOutOfTheMapAndIsNamed) {
  auto survey = corridor();
  survey[30].place.point.x_m = 5.0;    // of the second walk, at 47.5 m
  const auto building = Building::make(record_for("default"), survey);
  ASSERT_TRUE(building);
  EXPECT_EQ((*building)->site()->survey.size(), survey.size() - 1);
  ASSERT_EQ((*building)->doubts().size(), 1u);
  const DoubtfulPoint& doubtful = (*building)->doubts()[0];
  EXPECT_EQ(doubtful.doubt.point, 30u);
  EXPECT_EQ(doubtful.walk, "w1");
  EXPECT_EQ(doubtful.stated.point.x_m, 5.0);
  const auto open = Building::make(record_for("default"), survey, false);
  EXPECT_EQ((*open)->site()->survey.size(), survey.size());
  EXPECT_TRUE((*open)->doubts().empty());
}

class BuildingCorrector : public ::testing::Test {
 protected:
  BuildingCorrector() {
    DatabaseDirectory::Options options;
    options.own_thread = false;
    store_ = *DatabaseDirectory::open(folder_.path(), options);
  }

  BuildingId create(const std::string& pipeline, std::vector<ReferencePoint> survey) {
    BuildingId id;
    store_->create_building(record_for(pipeline), [&](Result<BuildingRecord> made) { id = made->id; });
    store_->store(id, SurveyBatch{"first", std::move(survey)}, [](Result<SurveyAck> ack) { ASSERT_TRUE(ack); });
    return id;
  }
  std::shared_ptr<const Building> build(BuildingId id) {
    BuildingShelf shelf;
    BuildingKeeper keeper(*store_, shelf, [](std::function<void()> task) { task(); });
    keeper.refresh(id);
    keeper.settle();
    return shelf.find(id);
  }
  std::optional<CorrectorRecord> stored(BuildingId id, const std::string& pipeline) {
    std::optional<CorrectorRecord> record;
    store_->with_building(id, [&](Result<BuildingDatabase*> database) { record = *(*database)->corrector(pipeline); });
    return record;
  }

  static std::string learnt(const Building& building) { return (*building.pipeline("p4"))->learnt(); }

  ScratchFolder folder_;
  std::unique_ptr<DatabaseDirectory> store_;
};

TEST_F(BuildingCorrector, IsStoredWithItsProvenanceAndNotTrainedAgain) {
  const BuildingId id = create("p4", corridor());
  const auto first = build(id);
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->remarks().empty());
  const auto kept = stored(id, "p4");
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->content, learnt(*first));
  EXPECT_EQ(kept->survey_version, first->record().survey_version);
  EXPECT_NE(kept->content.find("rmse_after_m"), std::string::npos);
  // A mark in the stored one shows that the next start takes it instead of training.
  auto marked = *kept;
  marked.content.insert(marked.content.find("\"walks\":") + 8, "4");
  store_->with_building(id, [&](Result<BuildingDatabase*> database) { ASSERT_TRUE((*database)->keep_corrector(marked)); });
  EXPECT_EQ(learnt(*build(id)), marked.content);
}

TEST_F(BuildingCorrector, OfAPresetThatOnlyASessionAskedForIsKeptToo) {
  const BuildingId id = create("nn", corridor());
  BuildingShelf shelf;
  BuildingKeeper keeper(*store_, shelf, [](std::function<void()> task) { task(); });
  keeper.refresh(id);
  EXPECT_TRUE(shelf.find(id)->prepared() == std::vector<std::string>{"nn"}) << "nobody asked for a pipeline that learns";
  const auto asked = shelf.find(id)->pipeline("p4");
  ASSERT_TRUE(asked);
  EXPECT_TRUE((*asked)->remarks().empty());
  EXPECT_FALSE(stored(id, "p4"));
  keeper.tick();
  const auto kept = stored(id, "p4");
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->content, (*asked)->learnt());
  EXPECT_EQ(kept->survey_version, shelf.find(id)->map_version());
  // A mark in it shows that the next start takes it instead of training, and that it is p4's alone.
  auto marked = *kept;
  marked.content.insert(marked.content.find("\"walks\":") + 8, "4");
  store_->with_building(id, [&](Result<BuildingDatabase*> database) { ASSERT_TRUE((*database)->keep_corrector(marked)); });
  const auto again = build(id);
  EXPECT_EQ(learnt(*again), marked.content);
  EXPECT_TRUE(again->newly_learnt().empty()) << "the store has it";
}

TEST_F(BuildingCorrector, IsHandedOverToBeKeptOnce) {
  const auto building = *Building::make(record_for("p4"), corridor());
  const auto told = building->newly_learnt();
  ASSERT_TRUE(told.contains("p4"));
  EXPECT_EQ(told.at("p4"), learnt(*building));
  EXPECT_TRUE(building->newly_learnt().empty());
}

TEST_F(BuildingCorrector, AnAbsentOneIsSaidByThePresetASessionAskedFor) {
  auto survey = corridor();
  for (auto& point : survey) point.walk.clear();
  const BuildingId id = create("nn", survey);
  const auto asked = build(id)->pipeline("p4");
  ASSERT_TRUE(asked);
  ASSERT_EQ((*asked)->remarks().size(), 1u);
  EXPECT_NE((*asked)->remarks()[0].find("no corrector"), std::string::npos);
}

TEST_F(BuildingCorrector, ASurveyThatGrewTrainsItAnew) {
  const BuildingId id = create("p4", corridor());
  build(id);
  const auto old = stored(id, "p4");
  auto more = corridor();
  for (auto& point : more) point.walk += " again";
  store_->store(id, SurveyBatch{"second", std::move(more)}, [](Result<SurveyAck> ack) { ASSERT_TRUE(ack); });
  build(id);
  EXPECT_GT(stored(id, "p4")->survey_version, old->survey_version);
  EXPECT_NE(stored(id, "p4")->content, old->content);
}

TEST_F(BuildingCorrector, ABrokenOneIsReplacedAndKeepsNoBuildingFromOpening) {
  const BuildingId id = create("p4", corridor());
  const auto first = build(id);
  store_->with_building(id, [&](Result<BuildingDatabase*> database) {
    ASSERT_TRUE((*database)->keep_corrector({"p4", first->record().survey_version, "{\"x\":1}"}));
  });
  const auto again = build(id);
  ASSERT_TRUE(again);
  EXPECT_EQ(learnt(*again), learnt(*first));
  EXPECT_EQ(stored(id, "p4")->content, learnt(*first));
}

TEST_F(BuildingCorrector, ThereIsNoneWithoutWalksAndTheBuildingSaysSo) {
  auto survey = corridor();
  for (auto& point : survey) point.walk.clear();
  const BuildingId id = create("p4", survey);
  const auto building = build(id);
  ASSERT_EQ(building->remarks().size(), 1u);
  EXPECT_NE(building->remarks()[0].find("no corrector"), std::string::npos);
  EXPECT_FALSE(stored(id, "p4"));
}

}  // namespace
}  // namespace wayfuse
