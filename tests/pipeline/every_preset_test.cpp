#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/pipeline/tracker.hpp"
#include "tests/locating/plan.hpp"
#include "tests/pipeline/odd_evidence.hpp"

// What holds for every preset there is.
namespace wayfuse {
namespace {

using testing::odd_site;
using testing::unsound;

PhoneTime at_s(double time_s) { return PhoneTime{from_seconds(time_s)}; }

Plan hall() {
  return Plan({"A....B....C",
               "...........",
               "D....E....F"}, 4.0);
}

MotionReport step(double time_s) {
  MotionReport motion;
  motion.time = at_s(time_s);
  motion.interval = from_seconds(0.5);
  motion.heading_sigma_rad = 0.1;
  motion.reference = HeadingReference::kTrue;
  motion.steps = 1;
  motion.step_length_m = 0.6;
  motion.distance_sigma_m = 0.06;
  return motion;
}

GnssFix satellites(double time_s) { return {at_s(time_s), {48.0, 11.0}, 5.0, {}, {}}; }

// 20 s eastwards with everything a phone can tell.
void walk(Tracker& tracker) {
  for (int i = 1; i <= 40; ++i) {
    tracker.feed(step(0.5 * i));
    if (i % 4 != 0) continue;
    tracker.feed(hall().scan_at({2.0 + 0.6 * i, 4.0}, at_s(0.5 * i)));
    tracker.feed(satellites(0.5 * i));
  }
}

class EveryPreset : public ::testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Tracker> tracker(std::shared_ptr<const Site> site, std::uint64_t seed = 1) {
    const auto factory = assemble(*preset(GetParam()), std::move(site));
    EXPECT_TRUE(factory);
    const KnownStart door{{{2.0, 4.0}, FloorOrdinal{0}}, 0.5, {}};
    return (*factory)->make_tracker(Random(seed), GetParam() == "dead-reckoning" ? std::optional(door) : std::nullopt);
  }
};
INSTANTIATE_TEST_SUITE_P(All, EveryPreset, ::testing::ValuesIn(preset_names()), [](const auto& info) {
  std::string name = info.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST_P(EveryPreset, TheSameSeedGivesTheSameBits) {
  const auto one = tracker(odd_site()), two = tracker(odd_site());
  walk(*one), walk(*two);
  ASSERT_TRUE(one->position(at_s(20.0)));
  EXPECT_EQ(one->position(at_s(20.0)), two->position(at_s(20.0)));
}

TEST_P(EveryPreset, TheOrderOfTheSurveyDoesNotMatter) {
  auto walked = std::make_shared<Site>(*odd_site());
  std::erase_if(walked->survey, [](const ReferencePoint& point) { return point.walk.empty(); });  // standing points are numbered as they come
  auto shuffled = std::make_shared<Site>(*walked);
  Random random(5);
  for (std::size_t i = shuffled->survey.size(); i > 1; --i) std::swap(shuffled->survey[i - 1], shuffled->survey[random.below(i)]);
  const auto one = tracker(walked), two = tracker(shuffled);
  walk(*one), walk(*two);
  const auto a = one->position(at_s(20.0)), b = two->position(at_s(20.0));
  ASSERT_TRUE(a && b);
  EXPECT_LT(distance_m(a->place.point, b->place.point), 1e-3) << "sums in another order differ in their last digits";
  EXPECT_EQ(a->place.floor, b->place.floor);
}

TEST_P(EveryPreset, TimeThatDoesNotPassMovesNobody) {
  const auto one = tracker(odd_site());
  walk(*one);
  const auto before = one->position(at_s(20.0));
  MotionReport again = step(20.0);
  again.step_length_m = 5.0;
  for (int i = 0; i < 10; ++i) one->feed(again);
  EXPECT_EQ(one->position(at_s(20.0))->place, before->place);
}

TEST_P(EveryPreset, ACompassThatKnowsNothingHoldsBackNoPosition) {
  const auto lost = tracker(odd_site());
  walk(*lost);
  MotionReport motion = step(20.5);
  motion.heading_sigma_rad = std::numbers::pi;
  lost->feed(motion);
  const auto position = lost->position(motion.time);
  ASSERT_TRUE(position);
  EXPECT_EQ(unsound(*position), "");
}

TEST_P(EveryPreset, AMinuteOfSilenceMakesLessSureAndNothingUnsound) {
  const auto one = tracker(odd_site());
  walk(*one);
  const double before_m = one->position(at_s(20.0))->radius95_m;
  const auto waited = one->position(at_s(80.0));
  ASSERT_TRUE(waited);
  EXPECT_GT(waited->radius95_m, before_m);
  MotionReport late = step(80.0);
  late.interval = from_seconds(60.0);
  late.steps = 100;
  one->feed(late);
  one->feed(hall().scan_at({30.0, 4.0}, at_s(80.0)));
  EXPECT_EQ(unsound(*one->position(at_s(80.0))), "");
}

TEST_P(EveryPreset, AnEmptyMapPublishesNoPlaceMadeUp) {
  auto empty = std::make_shared<Site>();
  const auto factory = assemble(*preset(GetParam()), empty);
  ASSERT_TRUE(factory);
  const auto one = (*factory)->make_tracker(Random(1));
  walk(*one);
  EXPECT_FALSE(one->position(at_s(20.0))) << "no survey, no georeference, no start";
  EXPECT_FALSE(one->why_no_fix().cause.empty());
}

}  // namespace
}  // namespace wayfuse
