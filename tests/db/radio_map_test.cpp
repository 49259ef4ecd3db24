#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <fstream>

#include "db/building_database.hpp"
#include "tests/db/survey_world.hpp"

namespace wayfuse {
namespace {

using testing::sample_batch;
using testing::sample_building;
using testing::TemporaryFolder;
using ::testing::ElementsAre;

class RadioMaps : public ::testing::Test {
 protected:
  RadioMapDraft draft(const std::string& content) {
    return {3, R"({"name":"p1"})", UnixTime(std::chrono::seconds(1'700'000'000)), content};
  }
  std::uint64_t staged(const std::string& content) { return database_.stage_map(draft(content)).value().version; }
  Publication publication(std::uint64_t version) {
    Publication publication;
    publication.version = version;
    publication.at = UnixTime(std::chrono::seconds(1'700'000'100));
    publication.by_key = 4;
    publication.reason = "spring survey";
    return publication;
  }
  std::uint64_t promote(std::uint64_t version) {
    const auto promoted = database_.promote(publication(version), database_.live_map().value());
    EXPECT_TRUE(promoted) << to_string(promoted.fault());
    return database_.live_map().value().value_or(0);
  }
  std::uint64_t rolled_back() {
    const auto back = database_.roll_back(publication(0));
    EXPECT_TRUE(back) << to_string(back.fault());
    EXPECT_EQ(back->version, database_.live_map().value());
    return back->version;
  }

  TemporaryFolder folder_;
  std::string file_ = folder_ / "building-7.sqlite";
  BuildingDatabase database_ = std::move(*BuildingDatabase::create(file_, sample_building(), {}));
};

TEST_F(RadioMaps, AreKeptByteByByteUnderTheirOwnVersion) {
  std::string bytes(100'000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7);
  const auto map = database_.stage_map(draft(bytes));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->bytes, bytes.size());
  EXPECT_EQ(map->survey_version, 3u);
  EXPECT_EQ(database_.map_content(map->version).value(), bytes);
  EXPECT_THAT(database_.maps().value(), ElementsAre(*map));
  EXPECT_EQ(database_.map_content(99).fault().code, FaultCode::kNotFound);
}

TEST_F(RadioMaps, TheSameContentIsTheSameVersion) {
  const std::uint64_t one = staged("one");
  const std::uint64_t two = staged("two");
  EXPECT_NE(one, two);
  EXPECT_EQ(staged("one"), one);
  EXPECT_EQ(database_.maps()->size(), 2u);
}

TEST_F(RadioMaps, ArePromotedAndRolledBackStepByStep) {
  EXPECT_EQ(database_.live_map().value(), std::nullopt);
  EXPECT_EQ(database_.roll_back(publication(0)).fault().code, FaultCode::kConflict);
  const std::uint64_t a = staged("a"), b = staged("b"), c = staged("c");
  EXPECT_EQ(promote(a), a);
  EXPECT_EQ(database_.roll_back(publication(0)).fault().code, FaultCode::kConflict) << "nothing before the first";
  EXPECT_EQ(promote(b), b);
  EXPECT_EQ(promote(c), c);
  EXPECT_EQ(rolled_back(), b);
  EXPECT_EQ(rolled_back(), a) << "a second rollback goes one further";
  EXPECT_EQ(promote(c), c);
  EXPECT_EQ(rolled_back(), a) << "what was live before c was promoted again";
  std::vector<std::pair<std::uint64_t, Publication::Act>> history;
  const std::vector<Publication> publications = database_.publications().value();
  for (const Publication& entry : publications) history.emplace_back(entry.version, entry.act);
  using enum Publication::Act;
  EXPECT_THAT(history, ElementsAre(std::pair(a, kPromoted), std::pair(b, kPromoted), std::pair(c, kPromoted), std::pair(b, kRolledBack),
                                   std::pair(a, kRolledBack), std::pair(c, kPromoted), std::pair(a, kRolledBack)));
  EXPECT_EQ(database_.publications()->front().reason, "spring survey");
  EXPECT_EQ(database_.publications()->front().by_key, 4u);
}

TEST_F(RadioMaps, APromotionThatLostTheRaceIsRefused) {
  const std::uint64_t a = staged("a"), b = staged("b");
  ASSERT_TRUE(database_.promote(publication(a), std::nullopt));
  const auto late = database_.promote(publication(b), std::nullopt);
  EXPECT_EQ(late.fault().code, FaultCode::kConflict);
  EXPECT_EQ(database_.promote(publication(a), a).fault().code, FaultCode::kConflict) << "live already";
  EXPECT_EQ(database_.promote(publication(77), a).fault().code, FaultCode::kNotFound);
  EXPECT_EQ(database_.live_map().value(), a);
}

TEST_F(RadioMaps, OnlyWhatWasNeverPublishedIsDiscarded) {
  const std::uint64_t a = staged("a"), b = staged("b");
  ASSERT_TRUE(database_.promote(publication(a), std::nullopt));
  EXPECT_EQ(database_.discard_map(a).fault().code, FaultCode::kConflict);
  EXPECT_TRUE(database_.discard_map(b));
  EXPECT_EQ(database_.discard_map(b).fault().code, FaultCode::kNotFound);
  EXPECT_GT(staged("b"), b) << "a version is never given twice";
}

TEST_F(RadioMaps, CannotBeChangedNotEvenByHand) {
  const std::uint64_t a = staged("a");
  promote(a);
  sqlite3* connection = nullptr;
  sqlite3_open(file_.c_str(), &connection);
  EXPECT_NE(sqlite3_exec(connection, "UPDATE radio_map SET recipe = 'x'", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_NE(sqlite3_exec(connection, "UPDATE publication SET version = 2", nullptr, nullptr, nullptr), SQLITE_OK);
  // Past the trigger, the hash still tells.
  EXPECT_EQ(sqlite3_exec(connection, "DROP TRIGGER radio_map_is_immutable; UPDATE radio_map SET content = x'62'", nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(connection);
  EXPECT_THAT(database_.verify()->wrong, ElementsAre("radio map 3 is not what was stored: a bit has changed"));
  EXPECT_EQ(database_.map_content(a).fault().code, FaultCode::kStoreCorrupt);
}

TEST_F(RadioMaps, AreMeasuredByRecordedWalks) {
  const std::uint64_t a = staged("a"), b = staged("b");
  const QualityWalkDraft lobby{"lobby round", "Pixel 7", UnixTime(std::chrono::seconds(1'700'000'000)), "recording bytes"};
  const auto walk = database_.add_quality_walk(lobby);
  ASSERT_TRUE(walk) << to_string(walk.fault());
  EXPECT_EQ(database_.add_quality_walk(lobby)->id, walk->id) << "the same walk again";
  QualityWalkDraft other = lobby;
  other.content = "another recording";
  EXPECT_EQ(database_.add_quality_walk(other).fault().code, FaultCode::kConflict) << "the name is taken";
  EXPECT_THAT(database_.quality_walks().value(), ElementsAre(*walk));
  EXPECT_EQ(database_.quality_walk_content(walk->id).value(), "recording bytes");

  MapQuality quality{a, walk->id, UnixTime(std::chrono::seconds(1'700'000'200)), 120, 3.1, 4.2, 2.6, 6.0, 0.99, 0.7, 0.96,
                     125, "p1@1", std::vector<float>(101, 2.5f)};
  ASSERT_TRUE(database_.note_quality(quality));
  quality.mean_m = 3.0;
  ASSERT_TRUE(database_.note_quality(quality));
  EXPECT_THAT(database_.qualities(a).value(), ElementsAre(quality));
  EXPECT_TRUE(database_.qualities(b)->empty());
  quality.floor_hit = 1.5;
  EXPECT_EQ(database_.note_quality(quality).fault().code, FaultCode::kOutOfRange);
  quality.floor_hit = 1;
  quality.walk_id = 9;
  EXPECT_EQ(database_.note_quality(quality).fault().code, FaultCode::kNotFound);
  ASSERT_TRUE(database_.remove_quality_walk(walk->id));
  EXPECT_TRUE(database_.qualities(a)->empty()) << "what was measured by it goes with it";
  EXPECT_EQ(database_.remove_quality_walk(walk->id).fault().code, FaultCode::kNotFound);
}

TEST_F(RadioMaps, SeeTheSurveyAsItWasAtTheirVersion) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) ASSERT_TRUE(database_.store({sample_batch(seed)}).at(0));
  const auto count = [&](std::optional<std::uint64_t> version) {
    return database_.points({.floor = {}, .after_id = 0, .most = 100, .through_version = version})->size();
  };
  EXPECT_EQ(count(std::nullopt), 6u);
  EXPECT_EQ(count(2), 4u);
  EXPECT_EQ(count(0), 0u);
}

}  // namespace
}  // namespace wayfuse
