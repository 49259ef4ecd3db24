#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "sdk/src/simulator/stand_in_phone.hpp"
#include "sdk/src/simulator/surveying.hpp"
#include "sdk/src/simulator/tracked_phone.hpp"

namespace wayfuse::simulator {
namespace {

World office(std::uint64_t seed = 1, OfficeSettings settings = {}) {
  Random random(seed);
  return make_office(settings, random);
}

TEST(World, IsReachableFromEveryRoomToEveryOther) {
  const World world = office();
  std::set<FloorOrdinal> floors;
  for (std::size_t i = 0; i < world.ways.size(); ++i) {
    EXPECT_FALSE(shortest_way(world, 0, i).empty()) << i;
    floors.insert(world.ways[i].place.floor);
  }
  EXPECT_EQ(floors.size(), 2u);
}

TEST(World, LetsNobodyWalkThroughAWallOrOutsideTheWalkableArea) {
  const World world = office();
  Random random(3);
  const Walker walker(world, {}, std::chrono::minutes(10), {}, random);
  int outside = 0, seen = 0;
  for (Duration t{0}; t < walker.length(); t += std::chrono::milliseconds(200)) {
    const Truth truth = walker.at(t);
    const Floor& plan = world.floors[static_cast<std::size_t>(truth.place.floor.value)].plan;
    ++seen;
    bool walkable = false;
    for (const Polygon& polygon : plan.walkable) walkable = walkable || contains(polygon, truth.place.point);
    outside += !walkable;
  }
  EXPECT_EQ(outside, 0) << "of " << seen;
}

TEST(Walker, MovesAsFastAsItsStepsSay) {
  const World world = office();
  Random random(5);
  const Walker walker(world, {}, std::chrono::minutes(5), {{0}}, random);
  double walked_m = 0;
  Truth last = walker.at(Duration{0});
  for (Duration t{0}; t < walker.length(); t += std::chrono::milliseconds(20)) {
    const Truth now = walker.at(t);
    if (now.place.floor == last.place.floor) {
      const double moved_m = distance_m(now.place.point, last.place.point);
      EXPECT_LT(moved_m, 0.05 + 1e-9);
      walked_m += moved_m;
    }
    last = now;
  }
  EXPECT_NEAR(walked_m / last.gait_phase, 0.67, 0.04);  // 0.70 at full speed, less at starts and stops
}

TEST(Propagation, WeakensWithDistanceWallsAndFloors) {
  World world = office();
  PropagationSettings quiet;
  quiet.shadowing_db = 0;
  quiet.body_db = 0;
  const Propagation propagation(world, quiet);
  const Transmitter& transmitter = world.transmitters[0];
  const Place near{{transmitter.point.x_m + 1, transmitter.point.y_m}, transmitter.floor};
  const Place far{{transmitter.point.x_m + 30, transmitter.point.y_m}, transmitter.floor};
  const Place above{near.point, {transmitter.floor.value + 1}};
  EXPECT_GT(propagation.level_dbm(0, near, {}), propagation.level_dbm(0, far, {}) + 20);
  EXPECT_GT(propagation.level_dbm(0, near, {}), propagation.level_dbm(0, above, {}) + 15);
}

TEST(Propagation, ShadowsAreAsStrongAsSaidAndTheSameNextTime) {
  const World world = office();
  PropagationSettings flat;
  flat.shadowing_db = 0;
  flat.body_db = 0;
  PropagationSettings shadowed = flat;
  shadowed.shadowing_db = 4;
  const Propagation without(world, flat), with(world, shadowed), again(world, shadowed);
  double squares = 0;
  int count = 0;
  for (double x = 1; x < 59; x += 1) {
    for (double y = 1; y < 31; y += 1) {
      for (std::size_t i = 0; i < world.transmitters.size(); i += 4) {
        const Place at{{x, y}, {0}};
        const double shadow = with.level_dbm(i, at, {}) - without.level_dbm(i, at, {});
        EXPECT_EQ(with.level_dbm(i, at, {}), again.level_dbm(i, at, {}));
        squares += shadow * shadow;
        ++count;
      }
    }
  }
  EXPECT_NEAR(std::sqrt(squares / count), 4.0, 0.6);
}

StandInPhone phone_of(const World& world, const Propagation& propagation, const Walker& walker, ScannerSettings scanner = {}) {
  StandInSettings settings;
  settings.scanner = scanner;
  return StandInPhone(world, propagation, walker, settings, Random(11));
}

TEST(StandInPhone, GivesTheSameBitsTwiceInTimeOrder) {
  const World world = office();
  const Propagation propagation(world, {});
  Random random(7);
  const Walker walker(world, {}, std::chrono::minutes(1), {}, random);
  StandInPhone a = phone_of(world, propagation, walker), b = phone_of(world, propagation, walker);
  PhoneTime last{};
  int scans = 0, samples = 0;
  while (auto event = a.next()) {
    EXPECT_TRUE(*event == *b.next());
    EXPECT_GE(time_of(*event), last);
    last = time_of(*event);
    std::holds_alternative<RssScan>(*event) ? ++scans : ++samples;
  }
  EXPECT_FALSE(b.next());
  EXPECT_GE(scans, 19);
  EXPECT_EQ(samples, 60 * 50);
}

TEST(StandInPhone, GyroscopeIntegratesToItsOwnTurns) {
  const World world = office();
  const Propagation propagation(world, {});
  Random random(9);
  const Walker walker(world, {}, std::chrono::minutes(1), {}, random);
  StandInPhone phone = phone_of(world, propagation, walker);
  // Along the up axis the turn rate must add up to the walker's own change of heading.
  double turned_rad = 0;
  const Heading first = phone.truth(PhoneTime{from_seconds(1000)}).heading;
  while (auto event = phone.next()) {
    if (const auto* sample = std::get_if<MargSample>(&*event)) {
      const auto a = *sample->acceleration_mps2;
      const double norm = std::hypot(a.x, a.y, a.z);
      const auto w = *sample->turn_rate_radps;
      turned_rad += (w.x * a.x + w.y * a.y + w.z * a.z) / norm * 0.02;
    }
  }
  const double error_rad = wrap_angle_rad(turned_rad - phone.truth(phone.end()).heading.minus(first));
  EXPECT_LT(std::abs(error_rad), 0.5);  // the accelerometer is only roughly up while walking
}

TEST(Scanner, HandsOutACacheWithTrueAges) {
  const World world = office();
  const Propagation propagation(world, {});
  Random random(7);
  const Walker walker(world, {}, std::chrono::minutes(5), {}, random);
  StandInPhone phone = phone_of(world, propagation, walker);
  int repeats = 0, scans = 0;
  std::map<std::uint64_t, PhoneTime> heard_at;
  while (auto event = phone.next()) {
    const auto* scan = std::get_if<RssScan>(&*event);
    if (!scan) continue;
    bool advanced = false;
    for (const ScanReading& reading : scan->readings) {
      EXPECT_GE(reading.age, Duration{0});
      EXPECT_LE(reading.rss_dbm, 0);
      const PhoneTime at = scan->time - reading.age;
      advanced = advanced || at > heard_at[reading.bssid.value];
      heard_at[reading.bssid.value] = std::max(at, heard_at[reading.bssid.value]);
    }
    ++scans;
    repeats += !advanced;
  }
  EXPECT_NEAR(static_cast<double>(repeats) / scans, 0.35, 0.12);
}

TEST(Scanner, KeepsToThePlatformsThrottle) {
  const World world = office();
  const Propagation propagation(world, {});
  Random random(7);
  const Walker walker(world, {}, std::chrono::minutes(4), {}, random);
  ScannerSettings throttled;
  throttled.throttled = true;
  throttled.repeat_share = 0;
  StandInPhone phone = phone_of(world, propagation, walker, throttled);
  std::vector<PhoneTime> fresh;
  std::uint64_t newest = 0;
  while (auto event = phone.next()) {
    const auto* scan = std::get_if<RssScan>(&*event);
    if (!scan || scan->readings.empty()) continue;
    PhoneTime latest{};
    for (const ScanReading& reading : scan->readings) latest = std::max(latest, scan->time - reading.age);
    const auto stamp = static_cast<std::uint64_t>(latest.time_since_epoch().count());
    if (stamp > newest) fresh.push_back(scan->time);
    newest = std::max(newest, stamp);
  }
  ASSERT_GE(fresh.size(), 5u);
  for (std::size_t i = 4; i < fresh.size(); ++i) EXPECT_GE(seconds(fresh[i] - fresh[i - 4]), 118);
}

TEST(Surveying, CoversTheFloorInBatchesTheProtocolTakes) {
  const World world = office();
  const Propagation propagation(world, {});
  const auto batches = survey_floor(world, propagation, {1}, {}, {}, Random(2));
  std::set<std::string> keys;
  std::size_t points = 0;
  double west = 100, east = 0;
  for (const SurveyBatch& batch : batches) {
    EXPECT_TRUE(keys.insert(batch.idempotency_key).second);
    EXPECT_LE(batch.points.size(), Limits::kPointsPerBatch);
    for (const ReferencePoint& point : batch.points) {
      EXPECT_EQ(point.place.floor, FloorOrdinal{1});
      west = std::min(west, point.place.point.x_m);
      east = std::max(east, point.place.point.x_m);
      ++points;
    }
  }
  EXPECT_GT(points, 200u);
  EXPECT_LT(west, 5);
  EXPECT_GT(east, 55);
}

TEST(ErrorLog, TellsMeanPercentileAndFloors) {
  ErrorLog log;
  for (int i = 1; i <= 9; ++i) log.add({{static_cast<double>(i), 0}, {i % 3 == 0}}, {{0, 0}, {0}});
  EXPECT_DOUBLE_EQ(log.mean_m(), 5);
  EXPECT_DOUBLE_EQ(log.percentile_m(0.5), 5);
  EXPECT_DOUBLE_EQ(log.percentile_m(1.0), 9);
  EXPECT_NEAR(log.floor_share(), 6.0 / 9, 1e-12);
  EXPECT_DOUBLE_EQ(log.last_m(), 9);
}

TEST(BuildingJson, NamesEveryFloorWithItsPlan) {
  const World world = office();
  const auto json = nlohmann::json::parse(to_building_json(world));
  EXPECT_EQ(json["name"], "Demo office");
  ASSERT_EQ(json["floors"].size(), 2u);
  EXPECT_EQ(json["floors"][1]["ordinal"], 1);
  EXPECT_GT(json["floors"][0]["walkable"].size(), 30u);
}

}  // namespace
}  // namespace wayfuse::simulator
