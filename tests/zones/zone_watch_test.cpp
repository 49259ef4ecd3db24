#include "server/zones/zone_watch.hpp"

#include <gtest/gtest.h>

#include "tests/fixtures/scratch_folder.hpp"
#include "tests/fixtures/still_clock.hpp"

namespace wayfuse {
namespace {

using std::chrono::seconds;

/// Two buildings over a real store without threads; zone 1 is a room of 10 m in building 1, on floor 0.
class ZoneWatchTest : public testing::Test {
 protected:
  ZoneWatchTest() {
    DatabaseDirectory::Options options;
    options.own_thread = false;
    store = *DatabaseDirectory::open(folder.path(), options);
    for (const char* name : {"One", "Two"}) {
      BuildingRecord record;
      record.name = name;
      store->create_building(record, [](Result<BuildingRecord> made) { ASSERT_TRUE(made); });
    }
    watch.emplace(*store, clock, 7, ZoneRules{});
    put_zone(zone(0, "Room", 10));
  }
  static ZoneRecord zone(std::uint64_t id, const char* name, double width_m) {
    ZoneRecord made;
    made.id = id;
    made.name = name;
    made.region = {{{{0, 0}, {width_m, 0}, {width_m, 10}, {0, 10}}}};
    return made;
  }
  void put_zone(const ZoneRecord& zone) {
    store->with_building({1}, [&](Result<BuildingDatabase*> database) { ASSERT_TRUE((*database)->put_zone(zone)); });
    watch->zones_changed({1});
  }
  // Walks along x from one place to another at 1.25 m/s, two positions a second.
  void walk(const std::string& tracked, double from_x, double to_x, std::int32_t floor = 0, double floor_probability = 1.0) {
    const int count = static_cast<int>(std::abs(to_x - from_x) / 0.625) + 1;
    for (int i = 0; i <= count; ++i) show(tracked, from_x + (to_x - from_x) * i / count, floor, floor_probability);
  }
  void show(const std::string& tracked, double x_m, std::int32_t floor = 0, double floor_probability = 1.0,
            Integrity integrity = Integrity::kOk) {
    clock.advance(std::chrono::milliseconds(500));
    phone_time += std::chrono::milliseconds(500);
    FusedPosition position;
    position.valid_at = phone_time;
    position.building = building;
    position.place = {{x_m, 5}, {floor}};
    position.floors = {{{floor}, floor_probability}, {{floor + 1}, 1 - floor_probability}};
    position.covariance = {1, 0, 1};
    position.radius95_m = 2.45;
    position.speed_mps = 1.25;
    position.integrity = integrity;
    watch->moved(tracked, position);
  }
  std::vector<std::string> told(std::uint64_t after = 0) const {
    std::vector<std::string> lines;
    for (const auto& [number, where, event] : watch->events_after(after, {}, 100).events) {
      lines.push_back(event.tracked + (event.transition == ZoneTransition::kEntered ? " entered " : " left ") + event.zone_name +
                      (event.retracts.empty() ? "" : " instead of " + event.retracts));
    }
    return lines;
  }
  using Lines = std::vector<std::string>;

  ScratchFolder folder;
  StillClock clock;
  std::unique_ptr<DatabaseDirectory> store;
  std::optional<ZoneWatch> watch;
  BuildingId building{1};
  PhoneTime phone_time{seconds(50)};
};

TEST_F(ZoneWatchTest, TellsEntryAndExitOfAWalkThroughARoom) {
  walk("a", -10, 20);
  EXPECT_EQ(told(), (Lines{"a entered Room", "a left Room"}));
  const auto news = watch->events_after(0, {1}, 100);
  EXPECT_EQ(news.events[0].event.id, "7-1");
  EXPECT_GE(news.events[0].event.probability, 0.9);
  EXPECT_LE(news.events[1].event.probability, 0.1);
  EXPECT_EQ(watch->counters().entered, 1u);
  EXPECT_EQ(watch->counters().left, 1u);
  EXPECT_EQ(watch->occupied(), 0u);
}

TEST_F(ZoneWatchTest, DoesNotBelieveAFloorThatIsInDoubt) {
  walk("a", -10, 5, 0, 0.85);
  EXPECT_EQ(told(), Lines{});
  walk("b", -10, 5, 1);
  EXPECT_EQ(told(), Lines{});
}

TEST_F(ZoneWatchTest, LetsASuspectPositionChangeNothing) {
  walk("a", -10, 5);
  for (int i = 0; i < 100; ++i) show("a", 40, 0, 1, Integrity::kSuspect);
  EXPECT_EQ(told(), Lines{"a entered Room"});
}

TEST_F(ZoneWatchTest, LeavesWithTheSession) {
  walk("a", -10, 5);
  EXPECT_EQ(watch->occupants({1}, 1).size(), 1u);
  EXPECT_EQ(watch->occupants({2}, 1).size(), 0u);
  watch->gone("a");
  EXPECT_EQ(told(), (Lines{"a entered Room", "a left Room"}));
  EXPECT_EQ(watch->occupants({1}, 1).size(), 0u);
  watch->gone("a");
  EXPECT_EQ(told().size(), 2u);
}

TEST_F(ZoneWatchTest, LeavesTheBuildingsZonesWithTheBuilding) {
  walk("a", -10, 5);
  building = {2};
  show("a", 5);
  EXPECT_EQ(told(), (Lines{"a entered Room", "a left Room"}));
}

TEST_F(ZoneWatchTest, TakesAnEntryBackThatAJumpDisproves) {
  walk("a", 0, 8);
  ASSERT_EQ(told(), Lines{"a entered Room"});
  walk("a", 60, 64);
  EXPECT_EQ(told(), (Lines{"a entered Room", "a left Room instead of 7-1"}));
  EXPECT_EQ(watch->counters().withdrawn, 1u);
}

TEST_F(ZoneWatchTest, FollowsZonesAsTheyChange) {
  walk("a", -10, 5);
  put_zone(zone(1, "Bigger", 30));
  walk("a", 5, 20);
  EXPECT_EQ(told(), Lines{"a entered Room"}) << "still inside of what the zone is now";
  EXPECT_EQ(watch->zones_by_phone({1})["a"], (std::vector<std::string>{"Bigger"}));
  store->with_building({1}, [&](Result<BuildingDatabase*> database) { ASSERT_TRUE((*database)->remove_zone(1)); });
  watch->zones_changed({1});
  show("a", 50);
  EXPECT_EQ(told().size(), 1u) << "a zone that is no more is left without a word";
  EXPECT_EQ(watch->zones(), 0u);
}

TEST_F(ZoneWatchTest, TellsDelayedExitsWhilePhonesAreSilent) {
  ZoneRecord slow = zone(1, "Room", 10);
  slow.exit_delay = seconds(30);
  put_zone(slow);
  walk("a", -10, 20);
  EXPECT_EQ(told(), Lines{"a entered Room"});
  clock.advance(seconds(31));
  watch->tick();
  EXPECT_EQ(told(), (Lines{"a entered Room", "a left Room"}));
}

TEST_F(ZoneWatchTest, WakesListenersUntilTheyEnd) {
  int woken = 0;
  auto listening = watch->on_event([&] { ++woken; });
  walk("a", -10, 5);
  EXPECT_EQ(woken, 1);
  listening.reset();
  watch->gone("a");
  EXPECT_EQ(woken, 1);
}

TEST(ZoneEventLog, SaysWhenEventsFellOutOfIt) {
  ZoneEventLog log(3);
  for (std::size_t i = 0; i < ZoneEventLog::kKept + 10; ++i) log.append({1}, {});
  EXPECT_TRUE(log.after(0, {}, 10).missed);
  EXPECT_TRUE(log.after(9, {}, 10).missed);
  const auto news = log.after(10, {}, 10);
  EXPECT_FALSE(news.missed);
  EXPECT_EQ(news.events.front().number, 11u);
  EXPECT_EQ(news.through, 20u);
  EXPECT_EQ(log.after(log.newest(), {}, 10).events.size(), 0u);
  EXPECT_EQ(log.after(10, {2}, 10'000).events.size(), 0u);
  EXPECT_EQ(log.after(10, {2}, 10'000).through, log.newest()) << "another building's events are passed over";
}

}  // namespace
}  // namespace wayfuse
