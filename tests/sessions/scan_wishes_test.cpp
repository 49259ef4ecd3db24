#include "server/sessions/scan_wishes.hpp"

#include <gtest/gtest.h>

namespace wayfuse {
namespace {

FusedPosition walking() {
  FusedPosition position;
  position.floors = {{FloorOrdinal{0}, 0.97}, {FloorOrdinal{1}, 0.03}};
  position.radius68_m = 3.0;
  position.speed_mps = 1.2;
  return position;
}
FusedPosition resting() {
  FusedPosition position = walking();
  position.speed_mps = 0.0;
  return position;
}

/// The hints said over so many equal answers.
template <typename Answer>
std::vector<ScanHint> said_over(int answers, Answer answer) {
  std::vector<ScanHint> said;
  for (int i = 0; i < answers; ++i) {
    if (const auto hint = answer()) said.push_back(*hint);
  }
  return said;
}

TEST(ScanWishes, AskForNoScansWhileAGoodPositionRests) {
  ScanWishes wishes;
  const auto walked = said_over(20, [&] { return wishes.after(walking()); });
  ASSERT_EQ(walked.size(), 1u) << "a wish is told once";
  EXPECT_EQ(walked[0].interval, std::chrono::seconds(5));
  const auto rested = said_over(20, [&] { return wishes.after(resting()); });
  ASSERT_EQ(rested.size(), 1u);
  EXPECT_EQ(rested[0].interval, Duration{0});
  EXPECT_EQ(said_over(20, [&] { return wishes.after(walking()); }).size(), 1u);
}

TEST(ScanWishes, AskForMoreWhileThePositionIsInDoubt) {
  FusedPosition wide = resting(), torn = resting(), suspect = resting();
  wide.radius68_m = 12.0;
  torn.floors = {{FloorOrdinal{0}, 0.6}, {FloorOrdinal{1}, 0.4}};
  suspect.integrity = Integrity::kSuspect;
  for (const FusedPosition& doubtful : {wide, torn, suspect}) {
    ScanWishes wishes;
    const auto said = said_over(5, [&] { return wishes.after(doubtful); });
    ASSERT_EQ(said.size(), 1u);
    EXPECT_EQ(said[0].interval, std::chrono::seconds(2));
  }
  ScanWishes wishes;
  EXPECT_EQ(said_over(5, [&] { return wishes.without_position(); }).size(), 1u);
}

TEST(ScanWishes, DoNotFlapWithEverySecondAnswer) {
  ScanWishes wishes;
  int turn = 0;
  EXPECT_TRUE(said_over(40, [&] { return wishes.after(turn++ % 2 == 0 ? walking() : resting()); }).empty());
}

}  // namespace
}  // namespace wayfuse
