#include "server/quality/accuracy_model.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "server/quality/survey_planner.hpp"
#include "tests/locating/plan.hpp"

namespace wayfuse {
namespace {

/// A hall of 80 x 16 m, surveyed in its western half only (every 4 m); phones can be everywhere.
std::shared_ptr<Site> half_surveyed() {
  const Plan plan({"A....B....C....D....E", ".....................", "F....G....H....I....J", "....................."}, 4.0);
  auto site = std::make_shared<Site>();
  site->survey = plan.survey(2);
  std::erase_if(site->survey, [](const ReferencePoint& point) { return point.place.point.x_m > 40.0; });
  Floor floor;
  floor.ordinal = {0};
  floor.outline = {{{{-1, -1}, {81, -1}, {81, 13}, {-1, 13}}}};
  site->floors = {floor};
  return site;
}

std::shared_ptr<const AccuracyModel> learnt(std::shared_ptr<const Site> site) {
  const auto model = AccuracyModel::learn(std::move(site), preset("wknn").value());
  EXPECT_TRUE(model) << to_string(model.fault());
  return *model;
}

double expected_at(const ExpectedAccuracy& accuracy, BuildingPoint point) {
  const auto column = static_cast<std::size_t>((point.x_m - accuracy.origin_x_m) / accuracy.cell_m);
  const auto row = static_cast<std::size_t>((point.y_m - accuracy.origin_y_m) / accuracy.cell_m);
  return accuracy.expected_m.at(row * static_cast<std::size_t>(accuracy.columns) + column).value();
}

TEST(AccuracyModel, ExpectsMoreErrorFartherFromTheSurvey) {
  const auto model = learnt(half_surveyed());
  EXPECT_GE(model->places(), AccuracyModel::kFewestPlaces);
  const auto accuracy = model->expected({0});
  ASSERT_TRUE(accuracy);
  EXPECT_GT(accuracy->median_m.value(), 0.0);
  const double surveyed = expected_at(*accuracy, {20, 6}), beside = expected_at(*accuracy, {50, 6}), far = expected_at(*accuracy, {75, 6});
  EXPECT_LT(surveyed, beside);
  EXPECT_LT(beside, far);
  EXPECT_EQ(std::accumulate(accuracy->points.begin(), accuracy->points.end(), 0u), 44u);  // 11 columns, 4 rows
  EXPECT_EQ(model->expected({5}).fault().code, FaultCode::kNotFound);
}

TEST(AccuracyModel, SaysThatATinySurveyTellsNothingOfItself) {
  auto site = half_surveyed();
  site->survey.resize(6);
  const auto model = learnt(site);
  EXPECT_NE(model->basis().find("general figures"), std::string::npos) << model->basis();
  EXPECT_TRUE(model->expected({0})->median_m.has_value());
}

TEST(AccuracyModel, IsTheSameForTheSameSurvey) {
  EXPECT_EQ(learnt(half_surveyed())->expected({0})->expected_m, learnt(half_surveyed())->expected({0})->expected_m);
}

TEST(SurveyPlan, WalksTheUnsurveyedHalfAndPromisesLessErrorEachTime) {
  const auto model = learnt(half_surveyed());
  const auto plan = plan_survey(*model, {0});
  ASSERT_TRUE(plan);
  ASSERT_FALSE(plan->walks.empty());
  double before = plan->median_now_m.value();
  for (const SurveyPlan::Walk& walk : plan->walks) {
    EXPECT_LE(walk.median_after_m, before);
    before = walk.median_after_m;
    EXPECT_LE(walk.length_m, 60.0 + 1e-9);
    EXPECT_FALSE(walk.why.empty());
    for (const BuildingPoint& corner : walk.path) {
      EXPECT_GT(corner.x_m, 40.0) << "surveyed ground is not walked again";
      EXPECT_LT(corner.x_m, 81.0);
    }
  }
  EXPECT_LT(before, plan->median_now_m.value());
}

TEST(SurveyPlan, IsEmptyWhereEverythingIsSurveyed) {
  auto site = half_surveyed();
  site->floors[0].outline = {{{{-1, -1}, {41, -1}, {41, 13}, {-1, 13}}}};
  const auto plan = plan_survey(*learnt(site), {0});
  ASSERT_TRUE(plan);
  EXPECT_TRUE(plan->walks.empty());
}

}  // namespace
}  // namespace wayfuse
