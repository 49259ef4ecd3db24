#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/evaluation/datasets/split.hpp"
#include "tests/evaluation/svg_chart.hpp"
#include "tests/evaluation/walks/measured.hpp"
#include "tests/evaluation/walks/replay.hpp"
#include "tests/evaluation/walks/selection.hpp"
#include "tests/evaluation/walks/survey_cover.hpp"
#include "tests/evaluation/walks/walk_score.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

PhoneTime at_ms(int milliseconds) {
  return PhoneTime(std::chrono::milliseconds(milliseconds));
}

// A walk along the x axis at 1 m/s from `x_m`, scans every second.
RecordedWalk straight_walk(const std::string& id, double x_m, int begin_ms, int seconds_long) {
  RecordedWalk walk;
  walk.id = id;
  walk.floor_label = "F1";
  walk.way_points = {{at_ms(begin_ms), {x_m, 0}}, {at_ms(begin_ms + 1000 * seconds_long), {x_m + seconds_long, 0}}};
  for (int s = 0; s <= seconds_long; ++s) walk.scans.push_back({at_ms(begin_ms + 1000 * s), {}});
  return walk;
}

FusedPosition position(double x_m, double y_m, double radius68_m) {
  FusedPosition position;
  position.place = {{x_m, y_m}, {0}};
  position.radius68_m = radius68_m;
  position.radius95_m = 2 * radius68_m;
  return position;
}

TEST(SurveyCover, ReachesThreeMetresFromThePath) {
  //   . (5, 2.9) covered
  //   +--------------+  survey (0,0) .. (10,0)
  //                       . (13.1, 0) not covered
  const SurveyCover cover(std::vector<RecordedWalk>{straight_walk("s", 0, 0, 10)});
  EXPECT_TRUE(cover.covers({{5, 2.9}, {0}}));
  EXPECT_FALSE(cover.covers({{5, 3.1}, {0}}));
  EXPECT_TRUE(cover.covers({{12.9, 0}, {0}}));
  EXPECT_FALSE(cover.covers({{13.1, 0}, {0}}));
  EXPECT_FALSE(cover.covers({{5, 0}, {1}})) << "another floor";
}

TEST(Throttled, HearsTheFirstScanAndThenEachThatIsLateEnough) {
  RecordedWalk walk = straight_walk("w", 0, 0, 10);
  std::erase_if(walk.scans, [](const RssScan& scan) { return scan.time == at_ms(4000); });
  const std::vector<ScoredWalk> phones = throttled(std::vector<ScoredWalk>{{walk, {"w"}}}, 4.0);
  ASSERT_EQ(phones.size(), 1u);
  std::vector<PhoneTime> heard;
  for (const RssScan& scan : phones[0].walk.scans) heard.push_back(scan.time);
  EXPECT_EQ(heard, (std::vector<PhoneTime>{at_ms(0), at_ms(5000), at_ms(9000)})) << "counted from the last one that was heard";
  EXPECT_EQ(phones[0].walk.way_points.size(), walk.way_points.size()) << "nothing else changes";
}

TEST(WalkScore, CountsErrorsFloorsAndCircles) {
  // Truth (0,0) (1,0) (2,0) at 0, 1, 2 s; answers: none, 3 m off inside its circle, 5 m off outside both circles on another
  // floor.
  const std::vector<ScoredWalk> walks = {{straight_walk("w", 0, 0, 2), {"w"}}};
  const SurveyCover cover(std::vector<RecordedWalk>{});
  const std::vector<std::vector<Instant>> instants = {instants_of(walks[0].walk, cover)};
  ASSERT_EQ(instants[0].size(), 3u) << "a scan at a way point's time asks once";
  PipelineRun run{"p", "direct", {{std::nullopt, position(1, 3, 4), position(2, 5, 2)}}, {1.0}};
  run.walks[0][2]->place.floor = {1};
  const ScoredData data{walks, instants};
  const ScoreRow row = score(data, run, Scope::kAll, nullptr, 1);
  EXPECT_EQ(row.asked, 3u);
  EXPECT_EQ(row.error.n, 2u);
  EXPECT_DOUBLE_EQ(row.error.mean, 4.0);
  EXPECT_DOUBLE_EQ(row.error.rmse, std::sqrt((9.0 + 25.0) / 2));
  EXPECT_DOUBLE_EQ(row.floor_hit, 0.5);
  EXPECT_DOUBLE_EQ(row.in68, 0.5);
  EXPECT_DOUBLE_EQ(row.in95, 0.5);
  EXPECT_DOUBLE_EQ(row.ttff_s, 1.0);
  EXPECT_EQ(score(data, run, Scope::kCovered, nullptr, 1).asked, 0u);
}

TEST(WalkScore, AWalkWithoutAFixIsInfinitelyLate) {
  const std::vector<ScoredWalk> walks = {{straight_walk("w", 0, 0, 2), {"w"}}};
  const std::vector<std::vector<Instant>> instants = {instants_of(walks[0].walk, SurveyCover(std::vector<RecordedWalk>{}))};
  const PipelineRun run{"p", "direct", {Answers(3)}, {std::nullopt}};
  EXPECT_TRUE(std::isinf(score({walks, instants}, run, Scope::kAll, nullptr, 1).ttff_s));
}

class SiteOnDisk : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("wayfuse-walks-" + std::to_string(::getpid()));
    fs::create_directories(folder_ / "F1/path_data_files");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void walk(const std::string& id, int begin_ms, double from_m, double to_m) {
    std::ofstream(folder_ / "F1/path_data_files" / (id + ".txt")) << begin_ms << "\tTYPE_WAYPOINT\t" << from_m << "\t0\n"
                                                                  << begin_ms + 10000 << "\tTYPE_WAYPOINT\t" << to_m << "\t0\n";
  }
  RecordedSite site() { return read_site(folder_.string(), {}).value(); }
  fs::path folder_;
};

// Ids by the split their hash puts them into.
std::string id_of(Split split, int nth) {
  for (int i = 0;; ++i) {
    const std::string id = "walk" + std::to_string(i);
    if (split_of(id) == split && nth-- == 0) return id;
  }
}

TEST_F(SiteOnDisk, WhatIsScoredNeverSurveys) {
  const std::string test = id_of(Split::kTest, 0), development = id_of(Split::kDevelopment, 0),
                    survey = id_of(Split::kSurvey, 0);
  walk(test, 0, 0, 10);
  walk(development, 100000, 0, 10);
  walk(survey, 200000, 0, 10);
  const auto names = [](const auto& walks, auto name) {
    std::vector<std::string> ids;
    for (const auto& walk : walks) ids.push_back(name(walk));
    std::sort(ids.begin(), ids.end());
    return ids;
  };
  const auto scored = [&](const Selection& s) { return names(s.scored, [](const ScoredWalk& w) { return w.walk.id; }); };
  const auto surveying = [&](const Selection& s) { return names(s.survey, [](const RecordedWalk& w) { return w.id; }); };
  const auto sorted = [](std::vector<std::string> ids) {
    std::sort(ids.begin(), ids.end());
    return ids;
  };
  const Selection usual = select_walks(site(), {}).value();
  EXPECT_EQ(scored(usual), std::vector{test});
  EXPECT_EQ(surveying(usual), sorted({development, survey}));
  const Selection inner = select_walks(site(), {.development = true, .chain = false, .only = {}}).value();
  EXPECT_EQ(scored(inner), std::vector{development});
  EXPECT_EQ(surveying(inner), std::vector{survey});
  const Selection listed = select_walks(site(), {.development = false, .chain = false, .only = {survey}}).value();
  EXPECT_EQ(scored(listed), std::vector{survey});
  EXPECT_EQ(surveying(listed), std::vector{development});
  const auto unknown = select_walks(site(), {.development = false, .chain = false, .only = {"nobody"}});
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.fault().cause.find("nobody"), std::string::npos);
}

TEST_F(SiteOnDisk, FoldsScoreEverySurveyWalkOnceAndNeverATestWalk) {
  std::vector<std::string> usable = {id_of(Split::kSurvey, 0), id_of(Split::kSurvey, 1), id_of(Split::kSurvey, 2), id_of(Split::kDevelopment, 0),
                                     id_of(Split::kDevelopment, 1)};
  const std::string test = id_of(Split::kTest, 0);
  int begin_ms = 0;
  for (const auto& id : usable) walk(id, begin_ms += 100000, 0, 10);
  walk(test, 0, 0, 10);
  std::vector<std::string> scored;
  for (int fold = 0; fold < 2; ++fold) {
    const Selection selection = select_walks(site(), {.only = {}, .folds = 2, .fold = fold}).value();
    EXPECT_EQ(selection.scored.size() + selection.survey.size(), usable.size());
    for (const ScoredWalk& each : selection.scored) {
      scored.push_back(each.walk.id);
      EXPECT_EQ(fold_of(each.walk.id, 2), fold);
      EXPECT_TRUE(std::ranges::none_of(selection.survey, [&](const RecordedWalk& other) { return other.id == each.walk.id; }));
    }
    EXPECT_TRUE(std::ranges::none_of(selection.survey, [&](const RecordedWalk& other) { return other.id == test; }));
  }
  std::ranges::sort(scored);
  std::ranges::sort(usable);
  EXPECT_EQ(scored, usable);
}

TEST_F(SiteOnDisk, AChainBelongsToTheFoldOfItsFirstWalkAndIsScoredOnce) {
  const std::string first = id_of(Split::kSurvey, 0), second = id_of(Split::kSurvey, 1);
  walk(first, 0, 0, 10);
  walk(second, 15000, 10.5, 20);
  int scored = 0;
  for (int fold = 0; fold < 5; ++fold) {
    const auto selection = select_walks(site(), {.chain = true, .only = {}, .folds = 5, .fold = fold});
    if (!selection) continue;  // nothing to score in this fold
    scored += static_cast<int>(selection->scored.size());
    EXPECT_EQ(fold, fold_of(first, 5));
    EXPECT_TRUE(selection->survey.empty());
  }
  EXPECT_EQ(scored, 1);
}

TEST_F(SiteOnDisk, AFoldWithNothingToScoreIsAnAnswerWhereFoldsAreAskedFor) {
  const std::string only = id_of(Split::kSurvey, 0);
  walk(only, 0, 0, 10);
  const int other = 1 - fold_of(only, 2);
  const auto empty = select_walks(site(), {.only = {}, .folds = 2, .fold = other, .may_be_empty = true});
  ASSERT_TRUE(empty) << to_string(empty.fault());
  EXPECT_TRUE(empty->scored.empty());
  EXPECT_NE(empty->nothing.find("none to score"), std::string::npos);
  EXPECT_EQ(empty->survey.size(), 1u);
  EXPECT_FALSE(select_walks(site(), {.only = {}, .folds = 2, .fold = other}));
}

TEST_F(SiteOnDisk, AFaultSaysWhichWalksCannotBeReadAndWhy) {
  const auto cause = [&](const SelectionOptions& options) {
    const auto selection = select_walks(site(), options);
    return selection ? std::string("none") : to_string(selection.fault());
  };
  const std::string test = id_of(Split::kTest, 0);
  std::ofstream(folder_ / "F1/path_data_files" / (test + ".txt")) << "hello\n";
  const std::string all = cause({});
  EXPECT_NE(all.find("1 of 1 walk files cannot be read"), std::string::npos) << all;
  EXPECT_NE(all.find(test + ".txt:1"), std::string::npos) << all;
  EXPECT_NE(cause({.only = {test}}).find(test + ".txt:1"), std::string::npos) << cause({.only = {test}});
  walk(id_of(Split::kTest, 1), 0, 0, 10);
  EXPECT_NE(cause({.chain = true, .only = {}}).find("no walk continues another one"), std::string::npos);
}

TEST_F(SiteOnDisk, WalksThatContinueEachOtherBecomeOne) {
  const std::string first = id_of(Split::kTest, 0), second = id_of(Split::kSurvey, 0), apart = id_of(Split::kTest, 1);
  walk(first, 0, 0, 10);
  walk(second, 15000, 10.5, 20);  // 5 s later, half a metre on
  walk(apart, 30000, 40, 50);     // 5 s later, elsewhere
  const Selection selection = select_walks(site(), {.development = false, .chain = true, .only = {}}).value();
  ASSERT_EQ(selection.scored.size(), 1u);
  EXPECT_EQ(selection.scored[0].parts, (std::vector{first, second}));
  EXPECT_DOUBLE_EQ(selection.scored[0].walk.duration_s(), 25.0);
  EXPECT_TRUE(selection.survey.empty());
}

TEST(WalkReply, LeavesOutWhatTheProtocolRefusesAndNothingElse) {
  WalkReply reply;
  EXPECT_TRUE(reply.leaves_out({FaultCode::kOutOfRange, "sample.turn_rate_degps", "-2005 is outside -2000..2000 deg/s"}));
  EXPECT_TRUE(reply.leaves_out({FaultCode::kOutOfRange, "sample.step_length_m", "9 is outside"}));
  EXPECT_FALSE(reply.leaves_out({FaultCode::kUnexpectedMessage, "", "the client has ended"}));
  EXPECT_EQ(reply.refused, 2u);
  EXPECT_EQ(reply.refusal->field, "sample.turn_rate_degps");
}

TEST(Pictures, CarryTitleAxesAndLegend) {
  const std::string svg =
      distribution_chart({"Error <all>", "metres", "share"}, {{"p1", {1, 2, 3}}, {"default", {0.5, 1}}}, 10.0);
  for (const char* part : {"Error &lt;all&gt;", "metres", "share", "p1", "default", "100 %", "</svg>"}) {
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  }
  Floor floor{{0}, "F1", {{{{0, 0}, {50, 0}, {50, 20}, {0, 20}}}}, {}};
  const std::string plan = plan_picture({"Plan", &floor, {}, {{"truth", "#000", {{1, 1}, {40, 10}}}}, false});
  EXPECT_NE(plan.find("20 m"), std::string::npos) << "the scale bar";
  EXPECT_NE(plan.find("truth"), std::string::npos);
}

}  // namespace
}  // namespace wayfuse
