#include "server/tracking/walkable_area.hpp"

#include <gtest/gtest.h>

namespace wayfuse {
namespace {

// A floor of 20 x 10 m whose middle is a shop:
//
//   0        7   13       20
//   +--------+---+--------+  10
//   |        | # |        |   #  the shop, from y = 0 to y = 7
//   +--------+---+--------+   0
Floor with_a_shop() {
  Floor floor;
  floor.ordinal = FloorOrdinal{0};
  floor.outline.rings = {{{0, 0}, {20, 0}, {20, 10}, {0, 10}}};
  floor.walkable = {Polygon{{{{0, 0}, {20, 0}, {20, 10}, {0, 10}}, {{7, 0}, {13, 0}, {13, 7}, {7, 7}}}}};
  return floor;
}

TEST(WalkableArea, ShopsAreClosedAndEdgesForgive) {
  const std::vector<Floor> floors = {with_a_shop()};
  const WalkableArea area(floors, {});
  const auto* plan = area.plan(FloorOrdinal{0});
  ASSERT_NE(plan, nullptr);
  EXPECT_TRUE(plan->open(3, 3));
  EXPECT_TRUE(plan->open(10, 9));
  EXPECT_FALSE(plan->open(10, 2));
  EXPECT_TRUE(plan->open(7.5f, 3));     // half a metre into the shop: plans and feet are inexact
  EXPECT_TRUE(plan->open(-1, 5));
  EXPECT_FALSE(plan->open(-5, 5));
  EXPECT_FALSE(plan->open(1e9f, 5));
}

TEST(WalkableArea, TellsHowFarOffThePlanAPointIs) {
  const std::vector<Floor> floors = {with_a_shop()};
  const WalkableArea area(floors, {});
  const auto* plan = area.plan(FloorOrdinal{0});
  EXPECT_TRUE(plan->open_within({3, 3}, 0.0));
  EXPECT_FALSE(plan->open_within({10, 2}, 0.0)) << "in the shop";
  EXPECT_TRUE(plan->open_within({10, 2}, 2.0));
  EXPECT_FALSE(plan->open_within({30, 5}, 8.0)) << "8.5 m to the forgiven edge";
  EXPECT_TRUE(plan->open_within({30, 5}, 9.0));
  EXPECT_TRUE(plan->open_within({-30, -40}, 1e9));
  EXPECT_FALSE(plan->open_within({1e15, -1e15}, 10.0));
}

TEST(WalkableArea, WhereSomebodyHasBeenIsOpen) {
  const std::vector<Floor> floors = {with_a_shop()};
  const std::vector<Place> trodden = {{{10.0, 2.0}, FloorOrdinal{0}}};
  const WalkableArea area(floors, trodden);
  EXPECT_TRUE(area.plan(FloorOrdinal{0})->open(10, 2));
  EXPECT_FALSE(area.plan(FloorOrdinal{0})->open(10, 5));
}

TEST(WalkableArea, AFloorWithoutAPlanIsOpenEverywhere) {
  const std::vector<Floor> floors = {Floor{}};
  EXPECT_EQ(WalkableArea(floors, {}).plan(FloorOrdinal{0}), nullptr);
}

}  // namespace
}  // namespace wayfuse
