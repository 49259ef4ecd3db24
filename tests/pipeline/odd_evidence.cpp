#include "tests/pipeline/odd_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/locating/plan.hpp"
#include "wayfuse/proto/codec.hpp"

namespace wayfuse::testing {
namespace {

constexpr std::uint64_t kStretch = 10000;    // inputs of one preset before the next has its turn

Plan hall() {
  return Plan({"A....B....C",
               "...........",
               "D....E....F"}, 4.0);
}

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

// Mostly up to 2 s; one in twenty as long as a report may be and longer, one in twenty of time that ran back.
Duration odd_interval(Random& random) {
  const auto kind = random.below(20);
  if (kind == 0) return from_seconds(-2.0 * random.uniform());
  return from_seconds((kind == 1 ? 70.0 : 2.0) * random.uniform());
}

// A place in the hall, or next door, or in the next town.
std::optional<KnownStart> odd_start(Random& random, bool always) {
  if (!always && random.below(3) != 0) return std::nullopt;
  const double far = random.below(10) == 0 ? 1000.0 : 1.0;
  KnownStart start{{{far * 40.0 * random.uniform(), far * 8.0 * random.uniform()}, FloorOrdinal{static_cast<std::int32_t>(random.below(3))}},
                   random.below(10) == 0 ? 0.0 : 3.0 * random.uniform(), {}};
  if (random.below(2) == 0) start.heading = Heading::from_radians(6.0 * random.uniform());
  return start;
}

// Along y, from end to end in 2 m steps of 2 s.
void survey_walk(Site& site, const Plan& plan, FloorOrdinal floor, double y_m, double length_m) {
  const auto number = static_cast<double>(site.survey.size());
  for (double x_m = 0.0; x_m <= length_m; x_m += 2.0) {
    ReferencePoint point;
    point.place = {{x_m, y_m}, floor};
    point.walk = "walk at " + std::to_string(y_m) + " on " + std::to_string(floor.value);
    point.scans = {plan.scan_at(point.place.point, PhoneTime{from_seconds(1000.0 * number + x_m)})};
    site.survey.push_back(std::move(point));
  }
}

Polygon rectangle(double x_m, double y_m, double width_m, double depth_m) {
  return {{{{x_m, y_m}, {x_m + width_m, y_m}, {x_m + width_m, y_m + depth_m}, {x_m, y_m + depth_m}}}};
}

PhoneTime odd_time(Random& random, double& now_s) {
  const auto kind = random.below(50);
  if (kind == 0) return PhoneTime{from_seconds(now_s - 100.0 * random.uniform())};
  if (kind == 1) now_s += 1000.0 * random.uniform();
  else if (kind > 4) now_s += random.uniform();
  return PhoneTime{from_seconds(now_s)};
}

void feed_odd(Tracker& tracker, Random& random, PhoneTime time) {
  const auto kind = random.below(10);
  if (kind < 6) tracker.feed(odd_motion(random, time));
  else if (kind < 9) tracker.feed(odd_scan(random, time));
  else tracker.feed(odd_fix(random, time));
}

}  // namespace

MotionReport odd_motion(Random& random, PhoneTime time) {
  MotionReport motion;
  motion.time = time;
  motion.interval = odd_interval(random);
  motion.heading = Heading::from_radians(odd(random, 6.0));
  motion.heading_sigma_rad = odd(random, 1.0);
  motion.reference = static_cast<HeadingReference>(random.below(3));
  motion.turn_rate_radps = odd(random, 3.0);
  motion.steps = static_cast<std::uint16_t>(random.below(3));
  motion.step_length_m = odd(random, 1.5);
  if (random.below(3) == 0) motion.speed_mps = odd(random, 3.0);
  motion.distance_sigma_m = odd(random, 1.0);
  motion.at_rest = random.below(5) == 0;
  if (random.below(4) == 0) motion.climb_m = odd(random, random.below(2) == 0 ? 3.0 : -3.0);
  return motion;
}

RssScan odd_scan(Random& random, PhoneTime time) {
  static const Plan plan = hall();
  RssScan scan = plan.scan_at({40.0 * random.uniform(), 8.0 * random.uniform()}, time);
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

GnssFix odd_fix(Random& random, PhoneTime time) {
  return {time, {48.0 + 1e-5 * odd(random, 10.0), 11.0 + 1e-5 * odd(random, 10.0)}, odd(random, 20.0), {}, {}};
}

std::shared_ptr<const Site> odd_site() {
  auto made = std::make_shared<Site>();
  made->georeference = Georeference{{48.0, 11.0}, 0.4};
  made->survey = hall().survey();
  const Plan above({"A....B", "......", "D....E"}, 4.0, 1);
  for (auto& point : above.survey()) made->survey.push_back(point);
  for (const double y_m : {1.0, 3.0, 5.0, 7.0}) survey_walk(*made, hall(), FloorOrdinal{0}, y_m, 40.0);
  for (const double y_m : {3.0, 5.0}) survey_walk(*made, above, FloorOrdinal{1}, y_m, 20.0);
  made->floors = {{FloorOrdinal{0}, "0", rectangle(-2.0, -2.0, 44.0, 12.0), {}, {{{14.0, -2.0}, {14.0, 2.0}}, {{26.0, 6.0}, {26.0, 10.0}}}},
                  {FloorOrdinal{1}, "1", rectangle(-2.0, -2.0, 24.0, 12.0), {rectangle(-2.0, -2.0, 24.0, 8.0)}}};
  return made;
}

std::string unsound(const FusedPosition& p) {
  if (const auto sound = check(p, "position"); !sound) return sound.fault().field + " " + sound.fault().cause;
  if (p.radius95_m < p.radius68_m) return "the 95 % circle is the smaller";
  double sum = 0.0;
  for (const auto& floor : p.floors) sum += floor.probability;
  return std::abs(sum - 1.0) < 1e-9 ? "" : "floor probabilities do not sum to 1";
}

OddFigures run_odd_evidence(std::uint64_t inputs, std::uint64_t seed, const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  const auto names = preset_names();
  const auto site = odd_site();
  std::vector<std::shared_ptr<const TrackerFactory>> factories;
  for (const std::string& name : names) factories.push_back(*assemble(*preset(name), site));
  OddFigures figures;
  Random random(seed);
  const std::uint64_t stretch = std::clamp<std::uint64_t>(inputs / names.size(), 1, kStretch);
  for (std::size_t turn = 0; figures.inputs < inputs; ++turn) {
    const std::size_t at = turn % names.size();
    const bool needs_start = names[at] == "dead-reckoning";
    const auto begin = [&] { return factories[at]->make_tracker(Random(random.bits()), odd_start(random, needs_start)); };
    auto tracker = begin();
    double now_s = 100.0;
    for (std::uint64_t i = 0; i < stretch && figures.inputs < inputs; ++i) {
      if (random.below(2000) == 0) tracker = begin();
      if (random.below(500) == 0) tracker = tracker->clone();
      const PhoneTime time = odd_time(random, now_s);
      feed_odd(*tracker, random, time);
      ++figures.inputs;
      const auto position = tracker->position(time);
      if (!position) continue;
      ++figures.positions;
      ++figures.of_preset[names[at]];
      if (const std::string cause = unsound(*position); !cause.empty()) {
        figures.fault = names[at] + ", input " + std::to_string(figures.inputs) + ": " + cause;
        return figures;
      }
    }
    if (progress) progress(figures.inputs, inputs);
  }
  return figures;
}

}  // namespace wayfuse::testing
