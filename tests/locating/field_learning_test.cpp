#include "server/locating/field_learning.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

constexpr std::array kDelays_s = {0.0, 1.0, 2.0, 3.0};

SurveyFit fit_of(int walks, const std::function<double(int walk)>& log_likelihood) {
  SurveyFit fit;
  for (int w = 0; w < walks; ++w) {
    fit.log_likelihood.push_back(log_likelihood(w));
    fit.scans.push_back(5);
  }
  return fit;
}

std::vector<SurveyFit> fits_about(int walks, const std::function<double(int walk)>& best_s) {
  std::vector<SurveyFit> fits;
  for (const double delay_s : kDelays_s) {
    fits.push_back(fit_of(walks, [&](int w) { return -10.0 - std::pow(delay_s - best_s(w), 2); }));
  }
  return fits;
}

TEST(LikeliestDelay, IsTheTopWhereAllWalksAgree) {
  EXPECT_NEAR(likeliest_delay_s(kDelays_s, fits_about(40, [](int) { return 2.3; })), 2.3, 1e-6);
  EXPECT_NEAR(likeliest_delay_s(kDelays_s, fits_about(40, [](int) { return 0.4; })), 0.4, 1e-6);
}

TEST(LikeliestDelay, IsThePriorsWhereNothingTells) {
  EXPECT_EQ(likeliest_delay_s(kDelays_s, fits_about(0, [](int) { return 0.0; })), 1.5);
  EXPECT_EQ(likeliest_delay_s(kDelays_s, std::vector(4, fit_of(40, [](int) { return -10.0; }))), 1.5);
}

TEST(LikeliestDelay, IsDrawnToThePriorWhereWalksDisagree) {
  const double agreed_s = likeliest_delay_s(kDelays_s, fits_about(40, [](int) { return 2.5; }));
  // One group of walks says 6 s, the others 2 s: 2.5 s on average.
  const double disputed_s = likeliest_delay_s(kDelays_s, fits_about(40, [](int w) { return w % 8 == 0 ? 6.0 : 2.0; }));
  EXPECT_NEAR(agreed_s, 2.5, 1e-6);
  EXPECT_LT(disputed_s, 2.45);
  EXPECT_GT(disputed_s, 1.5);
}

TEST(ClearlyBetter, TakesManyWalks) {
  const SurveyFit standard = fit_of(50, [](int w) { return -20.0 - w % 7; });
  EXPECT_TRUE(clearly_better(fit_of(50, [](int w) { return -19.0 - w % 7 + 0.3 * (w % 3); }), standard));
  EXPECT_FALSE(clearly_better(standard, standard));
  EXPECT_FALSE(clearly_better(fit_of(50, [](int w) { return w == 0 ? 30.0 : -20.0 - w % 7; }), standard)) << "one walk's opinion";
  EXPECT_FALSE(clearly_better(fit_of(1, [](int) { return 0.0; }), standard)) << "one walk in common";
  EXPECT_FALSE(clearly_better({}, {}));
}

/// A corridor of 60 m walked back and forth at 1 m/s; what a stamp of t shows was heard at t + `late_s`, with 2 dB of noise.
std::vector<ReferencePoint> walked(std::span<const double> radios_m, double late_s, double slope_dbm) {
  Random random(7);
  std::vector<ReferencePoint> survey;
  for (int walk = 0; walk < 16; ++walk) {
    for (int i = 0; i <= 30; ++i) {
      const auto place_m = [&](double t_s) { return walk % 2 ? 60.0 - t_s : t_s; };
      const double t_s = 2.0 * i + random.uniform(), heard_m = place_m(t_s + late_s);
      RssScan scan{PhoneTime(from_seconds(1000.0 * walk + t_s)), {}};
      for (std::size_t r = 0; r < radios_m.size(); ++r) {
        const double level = -35.0 - slope_dbm * std::abs(heard_m - radios_m[r]) + 2.0 * random.normal();
        if (level > -95.0) scan.readings.push_back({Bssid{0x00'10'00'00'00'00u + r}, level, Duration{0}, 2412, {}, {}});
      }
      survey.push_back({{{place_m(t_s), 0.0}, FloorOrdinal{0}}, 0.0, "phone", "walk " + std::to_string(walk), {}, {scan}});
    }
  }
  return survey;
}
constexpr std::array kRadios_m = {-5.0, 8.0, 20.0, 33.0, 47.0, 58.0, 66.0};

TEST(RadioFieldLearning, FindsTheStampsDelay) {
  for (const double late_s : {0.3, 2.6}) {
    const RadioField field(walked(kRadios_m, late_s, 1.5), {});
    EXPECT_NEAR(field.weights().delay_s, late_s, 0.5);
  }
}

TEST(RadioFieldLearning, KeepsToTheDelayOfASurveyOfStandingPoints) {
  auto survey = walked(kRadios_m, 0.0, 1.5);
  for (ReferencePoint& point : survey) point.walk.clear();
  EXPECT_EQ(RadioField(survey, {}).weights().delay_s, 1.5);
}

TEST(RadioFieldLearning, StaysWithTheUsualPowerUnlessTheSurveySaysOtherwise) {
  EXPECT_EQ(RadioField(walked(kRadios_m, 1.5, 1.0), {}).settings().strength.power, 2.72);
}

/// The first walk of `walked`, which lies this far along the corridor.
double first_place_m(const RadioField& field) {
  double sum = 0.0;
  int count = 0;
  for (const SurveyFingerprint& fingerprint : field.fingerprints()) {
    if (fingerprint.walk == 0) sum += fingerprint.place.point.x_m, ++count;
  }
  return sum / count;
}

TEST(ShiftsOfWalks, BringAWalkThatWasMarkedMetresOffNearerToTheOthers) {
  auto survey = walked(kRadios_m, 1.5, 1.5);
  for (ReferencePoint& point : survey) {
    if (point.walk == "walk 0") point.place.point.x_m += 4.0;
  }
  const RadioField as_marked(survey, {.delay_s = 1.5, .learn = false});
  const std::vector<BuildingPoint> shifts = shifts_of_walks(as_marked);
  ASSERT_EQ(shifts.size(), 16u);
  EXPECT_LT(shifts[0].x_m, -0.6);
  EXPECT_GT(shifts[0].x_m, -2.0) << "no more than half of the way";
  for (std::size_t walk = 1; walk < shifts.size(); ++walk) EXPECT_LT(std::abs(shifts[walk].x_m), 0.5) << walk;
  const RadioField learnt(survey, {.delay_s = 1.5});
  EXPECT_NEAR(first_place_m(learnt), first_place_m(as_marked) + shifts[0].x_m, 1e-6);
}

TEST(ShiftsOfWalks, StandingPointsStay) {
  auto survey = walked(kRadios_m, 0.0, 1.5);
  for (ReferencePoint& point : survey) point.walk.clear();
  for (const BuildingPoint& shift : shifts_of_walks(RadioField(survey, {.learn = false}))) EXPECT_EQ(shift, BuildingPoint{});
}

TEST(RadioFieldLearning, IsTheSameEveryTime) {
  const auto survey = walked(kRadios_m, 1.0, 1.5);
  const RadioField a(survey, {}), b(survey, {});
  EXPECT_EQ(a.weights().delay_s, b.weights().delay_s);
  EXPECT_EQ(a.weights().sorensen, b.weights().sorensen);
  EXPECT_EQ(a.weights().cosine, b.weights().cosine);
  EXPECT_EQ(first_place_m(a), first_place_m(b));
}

}  // namespace
}  // namespace wayfuse
