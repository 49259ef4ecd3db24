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

World world_of(WorldKind kind, std::uint64_t seed = 1) {
  Random random(seed);
  WorldSettings settings;
  settings.kind = kind;
  return make_world(settings, random);
}
World office(std::uint64_t seed = 1) { return world_of(WorldKind::kOffice, seed); }

class EveryWorld : public testing::TestWithParam<WorldKind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, EveryWorld, testing::Values(WorldKind::kOffice, WorldKind::kMall, WorldKind::kWarehouse),
                         [](const auto& kind) { return world_kind_names()[static_cast<std::size_t>(kind.param)]; });

TEST_P(EveryWorld, IsReachableFromEveryRoomToEveryOther) {
  const World world = world_of(GetParam());
  std::set<FloorOrdinal> floors;
  for (std::size_t i = 0; i < world.ways.size(); ++i) {
    EXPECT_FALSE(shortest_way(world, 0, i).empty()) << i;
    floors.insert(world.ways[i].place.floor);
  }
  EXPECT_EQ(floors.size(), world.floors.size());
}

TEST_P(EveryWorld, LetsNobodyWalkOutsideTheWalkableArea) {
  const World world = world_of(GetParam());
  Random random(3);
  const Walker walker(world, {}, std::chrono::minutes(20), {}, random);
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

TEST_P(EveryWorld, IsTheSameForTheSameSeed) {
  EXPECT_EQ(to_building_json(world_of(GetParam(), 5)), to_building_json(world_of(GetParam(), 5)));
}

TEST(World, HasHundredsOfRadiosInAMall) {
  const World mall = world_of(WorldKind::kMall);
  EXPECT_GE(mall.transmitters.size(), 150u);
  EXPECT_EQ(mall.floors.size(), 4u);
}

TEST(World, NamesTheSettingThatIsOutOfRange) {
  Random random(1);
  WorldSettings settings;
  settings.width_m = 10;
  try {
    make_world(settings, random);
    FAIL() << "a 10 m wide office was built";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("width"), std::string::npos) << error.what();
  }
}

// From the ground floor to the top by lift and one floor up by escalator: what carries people makes no steps.
std::vector<std::size_t> nodes_of(const World& world, Passage passage) {
  std::vector<std::size_t> nodes;
  for (std::size_t i = 0; i < world.ways.size(); ++i) {
    if (world.ways[i].passage == passage) nodes.push_back(i);
  }
  return nodes;
}

TEST(Walker, RidesALiftInOneGoWithTheForcesOfOne) {
  const World mall = world_of(WorldKind::kMall);
  Random random(3);
  const Walker walker(mall, {}, nodes_of(mall, Passage::kLift), random);
  double velocity_mps = 0, height_m = 0, most_mps2 = 0;
  for (Duration t{0}; t < walker.length(); t += std::chrono::milliseconds(10)) {
    const Truth truth = walker.at(t);
    most_mps2 = std::max(most_mps2, std::abs(truth.lift_mps2));
    velocity_mps += truth.lift_mps2 * 0.01;
    height_m += velocity_mps * 0.01;
  }
  EXPECT_NEAR(walker.at(walker.length()).height_m, 3 * mall.storey_m, 1e-6);
  EXPECT_NEAR(height_m, 3 * mall.storey_m, 0.2);   // the acceleration told adds up to the ride
  EXPECT_NEAR(velocity_mps, 0, 0.03);
  EXPECT_GT(most_mps2, 0.45);
  EXPECT_LE(most_mps2, 1.2);
  EXPECT_LT(walker.at(walker.length()).gait_phase, 1e-9);
}

TEST(Walker, IsCarriedByAnEscalatorWithoutAStep) {
  const World mall = world_of(WorldKind::kMall);
  for (const std::size_t from : nodes_of(mall, Passage::kEscalator)) {
    for (const std::size_t to : mall.ways[from].neighbours) {
      if (mall.ways[to].place.floor.value != mall.ways[from].place.floor.value + 1) continue;
      Random random(3);
      const Walker walker(mall, {}, {from, to}, random);
      EXPECT_LT(walker.at(walker.length()).gait_phase, 1e-9);
      EXPECT_LT(distance_m(walker.at(walker.length()).place.point, mall.ways[to].place.point), 0.01);
      EXPECT_NEAR(distance_m(mall.ways[from].place.point, mall.ways[to].place.point), 12.0, 1e-9);
    }
  }
}

TEST(Walker, TakesTheStairsForOneStoreyAndTheLiftForMany) {
  Random random(1);
  WorldSettings tower;
  tower.floors = 12;
  const World world = make_world(tower, random);
  const auto rides = [&](std::size_t to_floor) {
    std::size_t to = 0;
    while (!world.ways[to].room || world.ways[to].place.floor.value != static_cast<int>(to_floor)) ++to;
    for (const std::size_t node : shortest_way(world, 0, to)) {
      if (world.ways[node].passage == Passage::kLift) return true;
    }
    return false;
  };
  EXPECT_FALSE(rides(1));
  EXPECT_TRUE(rides(11));
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
  std::map<std::uint64_t, PhoneTime> heard_at;
  int rows = 0, old = 0;
  while (auto event = phone.next()) {
    const auto* scan = std::get_if<RssScan>(&*event);
    if (!scan) continue;
    for (const ScanReading& reading : scan->readings) {
      EXPECT_GE(reading.age, Duration{0});
      EXPECT_LT(reading.age, std::chrono::seconds(33));  // the cache's life, one delivery and its delay
      EXPECT_LE(reading.rss_dbm, 0);
      const PhoneTime at = scan->time - reading.age;
      const auto before = heard_at.find(reading.bssid.value);
      if (before != heard_at.end()) {
        EXPECT_GE(at + std::chrono::milliseconds(2), before->second);  // an older reading never comes back, its stamp may wander
        old += at <= before->second + std::chrono::milliseconds(2);
      }
      heard_at[reading.bssid.value] = at;
      ++rows;
    }
  }
  EXPECT_GT(old, rows / 10);
  EXPECT_LT(old, rows * 2 / 3);
}

TEST(Device, TellsLevelsWithItsOwnOffsetAndGain) {
  Device device;
  device.rss_offset_db = -4;
  device.rss_gain = 0.5;
  EXPECT_DOUBLE_EQ(device.told_dbm(-65), -69);
  EXPECT_DOUBLE_EQ(device.told_dbm(-85), -79);
  Random random(4);
  EXPECT_EQ(draw_device("stand-in C", random).model, "stand-in C");
  EXPECT_THROW(draw_device("no such phone", random), std::invalid_argument);
}

TEST(Carrying, ChangesWithoutTearingTheAttitude) {
  const World world = office();
  Random random(7);
  const Walker walker(world, {}, std::chrono::minutes(4), {}, random);
  const MotionSensors sensors(world, walker, {}, carrying_of("changing", random), Random(5));
  std::set<Carrying> modes;
  Quaternion last = sensors.attitude(Duration{0});
  for (Duration t{0}; t < walker.length(); t += std::chrono::milliseconds(10)) {
    const Quaternion now = sensors.attitude(t);
    const double agree = std::abs(now.w * last.w + now.x * last.x + now.y * last.y + now.z * last.z);
    EXPECT_GT(agree, std::cos(0.05));   // 10 rad/s at most
    modes.insert(sensors.carrying(t));
    last = now;
  }
  EXPECT_GE(modes.size(), 3u);
}

TEST(Scanner, KeepsToThePlatformsThrottle) {
  const World world = office();
  const Propagation propagation(world, {});
  Random random(7);
  const Walker walker(world, {}, std::chrono::minutes(4), {}, random);
  ScannerSettings throttled;
  throttled.throttled = true;
  StandInPhone phone = phone_of(world, propagation, walker, throttled);
  std::vector<PhoneTime> fresh;
  std::uint64_t newest = 0;
  while (auto event = phone.next()) {
    const auto* scan = std::get_if<RssScan>(&*event);
    if (!scan || scan->readings.empty()) continue;
    PhoneTime latest{};
    for (const ScanReading& reading : scan->readings) latest = std::max(latest, scan->time - reading.age);
    const auto stamp = static_cast<std::uint64_t>(latest.time_since_epoch().count());
    if (stamp > newest + 50'000) fresh.push_back(scan->time);   // stamps of one reading wander by a millisecond
    newest = std::max(newest, stamp);
  }
  ASSERT_GE(fresh.size(), 5u);
  for (std::size_t i = 4; i < fresh.size(); ++i) EXPECT_GE(seconds(fresh[i] - fresh[i - 4]), 117);
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
