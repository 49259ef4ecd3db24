#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/db/campaigns.hpp"
#include "tests/db/journal.hpp"
#include "tests/db/survey_world.hpp"

namespace wayfuse::testing {
namespace {

const Progress kSilent = [](std::uint64_t, std::uint64_t) {};

TEST(KillCampaign, HundredKillsLoseNothing) {
  const KillFigures figures = run_kill_campaign(100, 20261123, WAYFUSE_VICTIM, WAYFUSE_CHECKER, kSilent);
  EXPECT_THAT(figures.losses, ::testing::IsEmpty());
  EXPECT_EQ(figures.kills, 100u);
  EXPECT_GT(figures.acked, 500u) << "too little was under way for the kills to mean anything";
  RecordProperty("ready_worst_ms", std::to_string(figures.ready_worst_ms));
}

TEST(PowerCampaign, TwoHundredPowerCutsLoseNothing) {
  const PowerFigures figures = run_power_campaign(200, 1, false, kSilent);
  EXPECT_THAT(figures.losses, ::testing::IsEmpty());
  EXPECT_EQ(figures.cuts, 200u);
  EXPECT_GT(figures.acked, 1000u);
  EXPECT_GT(figures.unknown, 100u) << "the cuts do not fall into uploads";
}

TEST(PowerCampaign, ItsControlWithoutASyncACommitDoesLose) {
  const PowerFigures figures = run_power_campaign(200, 1, true, kSilent);
  EXPECT_GT(figures.lossy_cuts, 50u) << "a disk on which synchronous=NORMAL loses nothing proves nothing about FULL";
}

TEST(FindLosses, SeesWhatIsMissingForeignOrChanged) {
  const TemporaryFolder folder;
  Result<BuildingDatabase> database = BuildingDatabase::create(folder / "b.sqlite", sample_building(), {});
  ASSERT_TRUE(database);
  const Result<SurveyAck> ack = database->store({sample_batch(1)}).at(0);
  ASSERT_TRUE(ack);
  const auto losses = [&](const std::string& journal_text, bool settled = false) {
    Journal journal;
    note(journal_text, journal);
    return find_losses(folder / "b.sqlite", journal, settled);
  };
  const std::string sent = sent_line(sample_batch(1)), acked = acked_line(*ack);
  EXPECT_THAT(losses(sent + acked), ::testing::IsEmpty());
  EXPECT_THAT(losses(sent), ::testing::IsEmpty());
  EXPECT_THAT(losses(sent + acked + "sent batch-2 00\n"), ::testing::IsEmpty()) << "a line cut short is no line";
  EXPECT_THAT(losses(""), ::testing::ElementsAre("batch-1: stored, but never sent"));
  EXPECT_THAT(losses(sent + acked + sent_line(sample_batch(2)) + "acked batch-2 2 2 .\n"), ::testing::ElementsAre("batch-2: acknowledged, and lost"));
  EXPECT_THAT(losses(sent + acked + sent_line(sample_batch(2)), true), ::testing::ElementsAre("batch-2: sent and retried, and not there"));
  EXPECT_THAT(losses(sent + acked + "acked batch-1 2 9 .\n"), ::testing::Contains("batch-1: acknowledged twice, differently"));
  SurveyBatch other = sample_batch(1);
  other.points[0].scans[0].readings[0].rss_dbm += 0.5;
  EXPECT_THAT(losses(sent_line(other)), ::testing::ElementsAre("batch-1: its points are not those that were sent"));
}

}  // namespace
}  // namespace wayfuse::testing
