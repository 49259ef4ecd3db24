#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "server/pipeline/tracker.hpp"
#include "tests/locating/plan.hpp"

// Whatever is fed, nothing that is not a number is published. 20,000 evidences a run; WAYFUSE_CAMPAIGN=10000000 makes it the long one.
namespace wayfuse {
namespace {

Plan hall() {
  return Plan({"A....B....C",
               "...........",
               "D....E....F"}, 4.0);
}

std::shared_ptr<Site> site() {
  auto made = std::make_shared<Site>();
  made->georeference = Georeference{{48.0, 11.0}, 0.4};
  made->survey = hall().survey();
  const Plan above({"A....B", "......", "D....E"}, 4.0, 1);
  for (auto& point : above.survey()) made->survey.push_back(point);
  return made;
}

// Mostly sensible, sometimes at the edge, sometimes nonsense.
double odd(Random& random, double usual) {
  switch (random.below(40)) {
    case 0: return std::numeric_limits<double>::quiet_NaN();
    case 1: return std::numeric_limits<double>::infinity();
    case 2: return -std::numeric_limits<double>::infinity();
    case 3: return 1e300;
    case 4: return 0.0;
    case 5: return -usual;
    case 6: return std::numeric_limits<double>::denorm_min();
    default: return usual * random.uniform();
  }
}

PhoneTime odd_time(Random& random, double& now_s) {
  const auto kind = random.below(50);
  if (kind == 0) return PhoneTime{from_seconds(now_s - 100.0 * random.uniform())};
  if (kind == 1) now_s += 1000.0 * random.uniform();
  else if (kind > 4) now_s += random.uniform();
  return PhoneTime{from_seconds(now_s)};
}

MotionReport odd_motion(Random& random, PhoneTime time) {
  MotionReport motion;
  motion.time = time;
  motion.interval = Duration{static_cast<std::int64_t>(random.below(2000000))};
  motion.heading = Heading::from_radians(odd(random, 6.0));
  motion.heading_sigma_rad = odd(random, 1.0);
  motion.reference = static_cast<HeadingReference>(random.below(3));
  motion.turn_rate_radps = odd(random, 3.0);
  motion.steps = static_cast<std::uint16_t>(random.below(3));
  motion.step_length_m = odd(random, 1.5);
  if (random.below(3) == 0) motion.speed_mps = odd(random, 3.0);
  motion.distance_sigma_m = odd(random, 1.0);
  motion.at_rest = random.below(5) == 0;
  return motion;
}

RssScan odd_scan(Random& random, PhoneTime time) {
  RssScan scan = hall().scan_at({40.0 * random.uniform(), 8.0 * random.uniform()}, time);
  for (auto& reading : scan.readings) {
    if (random.below(20) == 0) reading.rss_dbm = odd(random, -100.0);
    if (random.below(10) == 0) reading.age = from_seconds(600.0 * random.uniform());
    if (random.below(20) == 0) reading.range_m = odd(random, 50.0);
    if (random.below(20) == 0) reading.range_sigma_m = odd(random, 5.0);
    if (random.below(30) == 0) reading.bssid = Bssid{random.bits() & 0xffffffffffff};
  }
  if (random.below(10) == 0) scan.readings.resize(random.below(scan.readings.size() + 1));
  if (random.below(50) == 0) scan.readings.clear();
  return scan;
}

void expect_sound(const FusedPosition& p, const std::string& name) {
  const double values[] = {p.place.point.x_m, p.place.point.y_m, p.covariance.xx_m2, p.covariance.xy_m2, p.covariance.yy_m2, p.radius68_m,
                           p.radius95_m, p.heading.radians(), p.heading_sigma_rad, p.speed_mps,
                           p.geo ? p.geo->latitude_deg : 0.0, p.geo ? p.geo->longitude_deg : 0.0};
  for (const double value : values) ASSERT_TRUE(std::isfinite(value)) << name;
  ASSERT_GE(p.covariance.xx_m2, 0.0) << name;
  ASSERT_GE(p.covariance.yy_m2, 0.0) << name;
  ASSERT_GE(p.radius95_m, p.radius68_m) << name;
  double sum = 0.0;
  for (const auto& floor : p.floors) sum += floor.probability;
  ASSERT_NEAR(sum, 1.0, 1e-9) << name;
}

TEST(HostileEvidence, PublishesNoNaN) {
  const char* wanted = std::getenv("WAYFUSE_CAMPAIGN");
  const auto names = preset_names();
  const long long each = (wanted ? std::atoll(wanted) : 20000) / static_cast<long long>(names.size());
  Random random(20261123);
  for (const std::string& name : names) {
    const auto factory = assemble(*preset(name), site());
    ASSERT_TRUE(factory) << name;
    auto tracker = (*factory)->make_tracker(Random(1));
    double now_s = 100.0;
    for (long long i = 0; i < each; ++i) {
      if (random.below(2000) == 0) tracker = (*factory)->make_tracker(Random(random.bits()));
      const PhoneTime time = odd_time(random, now_s);
      const auto kind = random.below(10);
      if (kind < 6) {
        tracker->feed(odd_motion(random, time));
      } else if (kind < 9) {
        tracker->feed(odd_scan(random, time));
      } else {
        tracker->feed(GnssFix{time, {48.0 + 1e-5 * odd(random, 10.0), 11.0 + 1e-5 * odd(random, 10.0)}, odd(random, 20.0), {}, {}});
      }
      if (const auto position = tracker->position(time)) expect_sound(*position, name);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(HostileEvidence, OneAccessPointAndThousands) {
  for (const int transmitters : {1, 3000}) {
    auto made = std::make_shared<Site>();
    Random random(3);
    for (int i = 0; i < 30; ++i) {
      ReferencePoint point;
      point.place = {{2.0 * (i % 6), 2.0 * (i / 6)}, FloorOrdinal{0}};
      RssScan scan;
      for (int t = 0; t < transmitters; ++t) {
        scan.readings.push_back({Bssid{static_cast<std::uint64_t>(t) + 1}, -50.0 - 3.0 * (i % 7) - 5.0 * random.uniform(), {}, 0, {}, {}});
      }
      point.scans = {scan};
      made->survey.push_back(point);
    }
    for (const auto& name : preset_names()) {
      const auto factory = assemble(*preset(name), made);
      ASSERT_TRUE(factory) << name;
      const auto tracker = (*factory)->make_tracker(Random(1));
      for (int i = 0; i < 3; ++i) {
        RssScan scan = made->survey[static_cast<std::size_t>(7 * i)].scans[0];
        scan.time = PhoneTime{from_seconds(1.0 + i)};
        tracker->feed(scan);
        if (const auto position = tracker->position(scan.time)) expect_sound(*position, name);
      }
    }
  }
}

TEST(HostileEvidence, TheOrderOfReadingsDoesNotMatter) {
  for (const auto& name : preset_names()) {
    const auto factory = *assemble(*preset(name), site());
    const auto one = factory->make_tracker(Random(1)), two = factory->make_tracker(Random(1));
    for (int i = 0; i < 10; ++i) {
      RssScan scan = hall().scan_at({3.0 * i, 4.0}, PhoneTime{from_seconds(1.0 + i)});
      one->feed(scan);
      std::reverse(scan.readings.begin(), scan.readings.end());
      two->feed(scan);
    }
    EXPECT_EQ(one->position(PhoneTime{from_seconds(11)}), two->position(PhoneTime{from_seconds(11)})) << name;
  }
}

}  // namespace
}  // namespace wayfuse
