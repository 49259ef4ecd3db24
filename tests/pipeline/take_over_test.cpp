#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/pipeline/tracker.hpp"
#include "tests/locating/plan.hpp"

// A walk goes on when its map is exchanged.
namespace wayfuse {
namespace {

PhoneTime at_s(double time_s) { return PhoneTime{from_seconds(time_s)}; }

// x = 0 .. 40, surveyed up to `surveyed_to_m`; `far_m` moves the whole building off.
std::shared_ptr<const Site> site(std::uint64_t version, double surveyed_to_m, double far_m = 0.0) {
  auto made = std::make_shared<Site>();
  made->building = BuildingId{1};
  made->radio_map_version = version;
  made->survey = Plan({"A....B....C", "...........", "D....E....F"}, 4.0).survey(2);
  std::erase_if(made->survey, [&](const ReferencePoint& point) { return point.place.point.x_m > surveyed_to_m; });
  for (std::size_t i = 0; i < made->survey.size(); ++i) {
    made->survey[i].place.point.x_m += far_m;
    made->survey[i].walk = "walk " + std::to_string(i % 4);
  }
  return made;
}

// Eastwards along y = 4, 1.2 m/s from x = 2, by a compass that is 0.2 rad off.
void walk(Tracker& tracker, int from_s, int to_s) {
  const Plan hall({"A....B....C", "...........", "D....E....F"}, 4.0);
  for (int i = from_s + 1; i <= to_s; ++i) {
    MotionReport motion;
    motion.time = at_s(i);
    motion.interval = from_seconds(1.0);
    motion.heading = Heading::from_radians(0.2);
    motion.heading_sigma_rad = 0.1;
    motion.reference = HeadingReference::kTrue;
    motion.steps = 2;
    motion.step_length_m = 0.6;
    motion.distance_sigma_m = 0.12;
    tracker.feed(motion);
    if (i % 2 == 0) tracker.feed(hall.scan_at({2.0 + 1.2 * i, 4.0}, at_s(i)));
  }
}

std::shared_ptr<const TrackerFactory> over(const std::string& name, std::shared_ptr<const Site> map) {
  const auto factory = assemble(*preset(name), std::move(map));
  EXPECT_TRUE(factory);
  return *factory;
}

// The papers' canyon has no radio map: it starts from satellites, or a door.
bool needs_start(const std::string& name) { return name == "dead-reckoning" || name.starts_with("p5"); }
bool has_map(const std::string& name) { return !needs_start(name); }

std::unique_ptr<Tracker> begun(const TrackerFactory& factory, std::uint64_t seed = 1) {
  const KnownStart door{{{2.0, 4.0}, FloorOrdinal{0}}, 0.5, {}};
  return factory.make_tracker(Random(seed), needs_start(factory.spec().name) ? std::optional(door) : std::nullopt);
}

class TakeOver : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, TakeOver, ::testing::ValuesIn(preset_names()), [](const auto& info) {
  std::string name = info.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST_P(TakeOver, ChangesTheMapsVersionAndNothingElseOfThePosition) {
  const auto half = over(GetParam(), site(1, 20.0)), whole = over(GetParam(), site(2, 40.0));
  const auto old = begun(*half);
  walk(*old, 0, 10);
  auto before = old->position(at_s(10));
  ASSERT_TRUE(before);
  EXPECT_EQ(before->radio_map_version, 1u);
  const auto taken = whole->take_over(*old);
  ASSERT_TRUE(taken);
  const auto after = taken->position(at_s(10));
  ASSERT_TRUE(after);
  EXPECT_EQ(after->radio_map_version, 2u);
  before->radio_map_version = 2;
  EXPECT_EQ(*after, *before);
  // And back: a rollback.
  const auto back = half->take_over(*taken);
  ASSERT_TRUE(back);
  before->radio_map_version = 1;
  EXPECT_EQ(back->position(at_s(10)), before);
  EXPECT_EQ(old->position(at_s(10)), before) << "the old tracker is a copy's model, and stays";
}

TEST_P(TakeOver, TheWalkGoesOnInTheNewMapTheSameBitsEveryTime) {
  if (!has_map(GetParam())) GTEST_SKIP() << "has no map";
  const auto half = over(GetParam(), site(1, 20.0)), whole = over(GetParam(), site(2, 40.0));
  const BuildingPoint truth{38.0, 4.0};
  constexpr int kSeeds = 8;
  double error_m = 0.0, stayed_m = 0.0, knew_all_m = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const auto taken_over = [&] {
      auto tracker = begun(*half, static_cast<std::uint64_t>(seed));
      walk(*tracker, 0, 16);  // to x = 21: where the half map ends
      tracker = whole->take_over(*tracker);
      walk(*tracker, 16, 30);
      return tracker->position(at_s(30));
    };
    const auto stayed = begun(*half, static_cast<std::uint64_t>(seed)), knew_all = begun(*whole, static_cast<std::uint64_t>(seed));
    walk(*stayed, 0, 30);
    walk(*knew_all, 0, 30);
    const auto end = taken_over();
    ASSERT_TRUE(end && stayed->position(at_s(30)));
    EXPECT_EQ(end, taken_over());
    error_m += distance_m(end->place.point, truth) / kSeeds;
    stayed_m += distance_m(stayed->position(at_s(30))->place.point, truth) / kSeeds;
    knew_all_m += distance_m(knew_all->position(at_s(30))->place.point, truth) / kSeeds;
  }
  EXPECT_LT(error_m, knew_all_m + 1.0) << "on the half map: " << stayed_m;
}

TEST_P(TakeOver, TheMiddleOfAFarAwaySurveyMovesAndTheTrackDoesNot) {
  if (!has_map(GetParam())) GTEST_SKIP() << "has no map";
  const double far_m = 50'000.0;
  const auto half = over(GetParam(), site(1, 20.0, far_m)), whole = over(GetParam(), site(2, 40.0, far_m));
  const auto old = begun(*half);
  walk(*old, 0, 10);
  const auto before = old->position(at_s(10));
  const auto taken = whole->take_over(*old);
  ASSERT_TRUE(before && taken);
  const auto after = taken->position(at_s(10));
  EXPECT_LT(distance_m(after->place.point, before->place.point), 1e-3);
}

TEST(GoOn, AnotherPipelineBeginsWhereTheOldOneStood) {
  const auto p1 = over("p1", site(1, 40.0)), walkers = over("default", site(1, 40.0));
  const auto old = begun(*p1);
  walk(*old, 0, 20);
  EXPECT_FALSE(walkers->take_over(*old));
  const auto taken = go_on(*walkers, *old, at_s(20), Random(3));
  const auto before = old->position(at_s(20)), after = taken->position(at_s(20));
  ASSERT_TRUE(after);
  // The mean of 1,000 places drawn about it.
  EXPECT_LT(distance_m(after->place.point, before->place.point), 5.0 * before->radius68_m / std::sqrt(1000.0));
}

TEST(GoOn, ABuildingThatWasTurnedBeginsTheTrackAnewWhereItStood) {
  auto turned = std::make_shared<Site>(*site(2, 40.0));
  turned->georeference = Georeference{{48.0, 11.0}, 1.0};
  const auto straight = over("default", site(1, 40.0)), after_turn = over("default", turned);
  const auto old = begun(*straight);
  walk(*old, 0, 20);
  EXPECT_FALSE(after_turn->take_over(*old)) << "what was learnt of the compass no longer holds";
  const auto taken = go_on(*after_turn, *old, at_s(20), Random(3));
  ASSERT_TRUE(taken->position(at_s(20)));
  EXPECT_LT(distance_m(taken->position(at_s(20))->place.point, old->position(at_s(20))->place.point), 1.0);
}

TEST(GoOn, WithoutAPositionItBeginsAsAnybodyDoes) {
  const auto p1 = over("p1", site(1, 40.0)), walkers = over("default", site(1, 40.0));
  EXPECT_FALSE(go_on(*walkers, *begun(*p1), at_s(0), Random(3))->position(at_s(0)));
}

TEST(GoOn, AFloorTheNewMapLacksIsForgottenWithTheNextScan) {
  auto two_floors = std::make_shared<Site>(*site(1, 40.0));
  for (ReferencePoint point : Plan({"A....B....C", "...........", "D....E....F"}, 4.0, 1).survey(2)) two_floors->survey.push_back(point);
  const auto both = over("default", two_floors), one = over("default", site(2, 40.0));
  auto tracker = begun(*both);
  walk(*tracker, 0, 4);
  ASSERT_EQ(tracker->position(at_s(4))->floors.size(), 2u);
  tracker = one->take_over(*tracker);
  walk(*tracker, 4, 6);
  const auto floors = tracker->position(at_s(6))->floors;
  ASSERT_EQ(floors.size(), 1u);
  EXPECT_EQ(floors[0].probability, 1.0);
}

}  // namespace
}  // namespace wayfuse
