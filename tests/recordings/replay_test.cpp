#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/recordings/recorded_house.hpp"

namespace wayfuse {
namespace {

using testing::HasSubstr;

std::vector<FusedPosition> said(const ReplayAnswer& answer) {
  std::vector<FusedPosition> positions;
  for (const ReplayStep& step : answer.page) {
    if (step.said && step.explanation) positions.push_back(step.explanation->position);
  }
  return positions;
}

// Whatever happens to a session while it is recorded, living through it again gives the same bits.
class ReplayedSession : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Seeds, ReplayedSession, testing::Range(1, 41));

TEST_P(ReplayedSession, IsBitForBitWhatThePhoneWasTold) {
  Random random(static_cast<std::uint64_t>(GetParam()));
  const auto any = [&](auto... values) {
    const std::vector<std::string> all{values...};
    return all[random.below(all.size())];
  };
  RecordedHouse world(static_cast<std::uint64_t>(GetParam()));
  if (random.below(4) > 0) world.survey(0, 20, "first");
  world.set_pipeline(any("default", "p1", "p4", "wknn"));
  if (random.below(2) == 0) world.record();
  WalkingPhone phone(world, any("", "", "default", "p2", "p3", "nn"));
  std::size_t told_before = 0;
  int surveys = 0;
  bool recording = world.desk->state(world.hall)->until.has_value();
  for (int i = 0; i < 60; ++i) {
    world.house.clock.advance(std::chrono::seconds(1));
    std::vector<SampleBody> bodies = phone.second();
    switch (random.below(12)) {
      case 0: if (surveys++ < 4) world.survey(20, 100, "more " + std::to_string(i)); break;
      case 1: world.set_pipeline(any("default", "p1", "wknn")); break;
      case 2: world.with_database([](BuildingDatabase& database) { static_cast<void>(database.roll_back({})); }); break;
      case 3: phone.connect(); break;
      case 4: bodies.push_back(SessionHouse::hall().scan_at({20, 4}, at(phone.now_s - 1.5))); break;  // a straggler
      case 5: bodies.push_back(step_at(phone.now_s - 60.0)); break;                                  // too late to count
      case 6: {
        for (SampleBody& body : phone.second()) bodies.push_back(std::move(body));
        break;
      }
      default: break;
    }
    if (!recording && random.below(8) == 0) {
      world.record();
      recording = true;
      told_before = phone.told.size();
    }
    phone.send(std::move(bodies));
  }
  if (!recording) return;
  const auto listed = world.list();
  ASSERT_EQ(listed.size(), 1u);
  ASSERT_GT(phone.told.size(), told_before);
  const std::vector<FusedPosition> live(phone.told.begin() + static_cast<std::ptrdiff_t>(told_before), phone.told.end());
  const auto again = world.replay_all(listed[0].id);
  EXPECT_TRUE(again.as_it_was);
  EXPECT_EQ(again.differing, 0u);
  EXPECT_TRUE(said(again) == live) << said(again).size() << " positions, live " << live.size();
  // Once every snapshot it went over is retired, they are made again from the store.
  world.set_pipeline("nn");
  phone.walk(8);
  const auto later = world.replay_all(listed[0].id);
  EXPECT_EQ(later.differing, 0u);
  const auto now = said(later);
  ASSERT_GE(now.size(), live.size());
  EXPECT_TRUE(std::equal(live.begin(), live.end(), now.begin()));
}

class Replay : public testing::Test, public RecordedHouse {
 protected:
  Replay() { survey(0, 20, "west"), set_pipeline("default"); }
};

TEST_F(Replay, ByAnotherPipelineAndOnAnotherMap) {
  record();
  WalkingPhone phone(*this, "");
  phone.walk(20);
  survey(20, 100, "east");
  phone.walk(20);
  const RecordingSummary recording = list().at(0);
  EXPECT_TRUE(recording.from_the_start);
  EXPECT_NE(recording.first_map, recording.last_map);
  const auto by_wknn = replay_all(recording.id, {.pipeline = "wknn", .map_version = {}});
  EXPECT_FALSE(by_wknn.as_it_was);
  EXPECT_EQ(by_wknn.pipeline, "wknn");
  EXPECT_EQ(by_wknn.page.front().map_version, recording.first_map) << "the maps as they were";
  EXPECT_EQ(by_wknn.page.back().map_version, recording.last_map);
  EXPECT_FALSE(by_wknn.page.back().as_live) << "another pipeline is not held against the live one";
  const auto on_whole = replay_all(recording.id, {.pipeline = {}, .map_version = recording.last_map});
  for (const ReplayStep& step : on_whole.page) EXPECT_EQ(step.map_version, recording.last_map);
  // A session that begins on that map now is the same walk, but for its seed.
  const auto same_again = replay_all(recording.id, {.pipeline = "wknn", .map_version = recording.last_map});
  EXPECT_EQ(same_again.page.size(), by_wknn.page.size());
}

TEST_F(Replay, OnARetiredMapThatIsReadBackFromTheStore) {
  const auto half = house.buildings.find(hall)->map_version();
  survey(20, 100, "east");
  record();
  WalkingPhone phone(*this, "wknn");
  phone.walk(30);
  const auto on_half = replay_all(list().at(0).id, {.pipeline = {}, .map_version = half});
  EXPECT_EQ(on_half.page.back().map_version, half);
  const auto nowhere = replay(list().at(0).id, {.pipeline = {}, .map_version = 999});
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.fault().field, "radio_map_version");
  EXPECT_EQ(replay(list().at(0).id, {.pipeline = "p9", .map_version = {}}).fault().code, FaultCode::kUnknownName);
}

TEST_F(Replay, ExplainsEachStepAsTheLiveSessionDid) {
  record();
  WalkingPhone phone(*this, "p1");
  for (int i = 0; i < 10; ++i) {
    phone.walk(1);
    const auto live = house.sessions.find_tracked(phone.welcome->tracked)->explain();
    if (!live) continue;
    const auto step = replay(list().at(0).id, {.pipeline = {}, .map_version = {}, .after = static_cast<std::uint64_t>(i), .most = 1, .particles = 500});
    ASSERT_TRUE(step && step->page.size() == 1 && step->page[0].explanation);
    const Explanation& again = *step->page[0].explanation;
    EXPECT_EQ(again.tracked, live->tracked);
    EXPECT_EQ(again.position, live->position);
    EXPECT_EQ(again.doubts, live->doubts);
    ASSERT_EQ(again.readings.size(), live->readings.size());
    for (std::size_t r = 0; r < again.readings.size(); ++r) {
      EXPECT_EQ(again.readings[r].bssid, live->readings[r].bssid);
      EXPECT_EQ(again.readings[r].rejected, live->readings[r].rejected);
      EXPECT_EQ(again.readings[r].residual_db(), live->readings[r].residual_db());
    }
    ASSERT_EQ(again.particles.size(), live->particles.size());
    for (std::size_t p = 0; p < again.particles.size(); ++p) EXPECT_EQ(again.particles[p].point, live->particles[p].point);
  }
}

TEST_F(Replay, SaysThatPointsOfTheMapWereErasedSince) {
  record();
  WalkingPhone phone(*this, "wknn");
  phone.walk(6);
  with_database([](BuildingDatabase& database) {
    EraseQuery query;
    query.walk = "west4";
    ASSERT_TRUE(database.erase(query));
  });
  phone.walk(10);  // onto the newer snapshot: the one of before is gone
  const auto answer = replay(list().at(0).id);
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->remarks, testing::Contains(HasSubstr("were erased since")));
}

TEST_F(Replay, ItsContentIsWhatThePhoneSent) {
  record();
  WalkingPhone phone(*this, "wknn");
  phone.walk(4);
  const auto lines = desk->content(list().at(0).id, hall);
  ASSERT_TRUE(lines);
  std::string text;
  while (const auto portion = (*lines)->next()) text += *portion;
  std::istringstream in(text);
  std::vector<nlohmann::json> read;
  for (std::string line; std::getline(in, line);) read.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(read.size(), 1u + 6u);
  EXPECT_EQ(read[0]["type"], "wayfuse-recording");
  EXPECT_EQ(read[0]["building"], "Hall");
  EXPECT_EQ(read[1]["type"], "motion");
  EXPECT_EQ(read[1]["steps"], 2);
  EXPECT_EQ(read[3]["type"], "scan");
  EXPECT_EQ(read[3]["readings"].size(), 6u);
  for (std::size_t i = 1; i < read.size(); ++i) EXPECT_EQ(read[i]["sequence"], i);
}

}  // namespace
}  // namespace wayfuse
