#include <benchmark/benchmark.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <ranges>
#include <vector>

#include "server/locating/radio_map.hpp"
#include "server/locating/rss_distance.hpp"
#include "server/pipeline/tracker.hpp"
#include "server/sessions/timeline.hpp"
#include "server/tracking/fix_measurement.hpp"
#include "server/tracking/particle_filter.hpp"
#include "server/tracking/resamplers.hpp"
#include "server/tracking/walk_motion.hpp"
#include "tests/benchmarks/match_world.hpp"

// The engine's hot paths beside naive baselines in the same run. ns a particle, us a scan.
namespace wayfuse {
namespace {

void per_particle(benchmark::State& state) { state.counters["a particle"] = time_per_particle(); }

// What one writes first: structures, a standard generator, exp and log, a copy on resampling.
void particles_naive(benchmark::State& state) {
  struct Particle {
    double x = 0, y = 0, weight = 1.0 / kParticles;
  };
  std::vector<Particle> particles(kParticles), next(kParticles);
  Random random(1);
  double truth = 0.0;
  for (auto _ : state) {
    truth += 0.7;
    double sum = 0.0;
    for (Particle& p : particles) {
      p.x += 0.7 + 0.3 * random.normal();
      p.y += 0.3 * random.normal();
      p.weight *= std::exp(-((p.x - truth) * (p.x - truth) + p.y * p.y) / 18.0);
      sum += p.weight;
    }
    for (Particle& p : particles) p.weight /= sum;
    double reached = particles[0].weight;
    const double first = random.uniform() / kParticles;
    for (std::size_t k = 0, i = 0; k < kParticles; ++k) {
      while (first + static_cast<double>(k) / kParticles >= reached && i + 1 < kParticles) reached += particles[++i].weight;
      next[k] = {particles[i].x, particles[i].y, 1.0 / kParticles};
    }
    particles.swap(next);
  }
  per_particle(state);
}
BENCHMARK(particles_naive);

void particles_wayfuse(benchmark::State& state) {
  ParticleFilter filter({static_cast<int>(kParticles), 1.0}, std::make_shared<WalkMotion>(WalkSettings{}),
                        std::make_shared<SystematicResampler>());
  Random random(1);
  filter.start(isotropic({}, 2.0, 1.0), random);
  const Motion step{.dt_s = 0.5, .heading_rad = 0.0, .heading_sigma_rad = 0.1, .distance_m = 0.7, .distance_sigma_m = 0.3};
  double truth = 0.0;
  for (auto _ : state) {
    truth += 0.7;
    filter.predict(step, random);
    filter.update(FixMeasurement(truth, 0.0, 3.0), random);
  }
  per_particle(state);
}
BENCHMARK(particles_wayfuse);

// --- matching -------------------------------------------------------------------------------------------------------------

void match_dense_naive(benchmark::State& state) {
  const MatchWorld& world = match_world(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)));
  const std::size_t columns = world.map->transmitters().size(), points = world.map->points().size();
  std::vector<float> wanted;
  KnownScan known;
  std::size_t turn = 0;
  for (auto _ : state) {
    dense_row(world, world.scans[turn++ % world.scans.size()], known, wanted);
    float least = INFINITY;
    std::size_t best = 0;
    for (std::size_t j = 0; j < points; ++j) {
      float sum = 0.0f;
      for (std::size_t i = 0; i < columns; ++i) {
        const float difference = wanted[i] - world.dense[j * columns + i];
        sum += difference * difference;
      }
      if (sum < least) least = sum, best = j;
    }
    benchmark::DoNotOptimize(best);
  }
}
BENCHMARK(match_dense_naive)->Args({10000, 500})->Unit(benchmark::kMicrosecond);

void match_wayfuse(benchmark::State& state) {
  const MatchWorld& world = match_world(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)));
  const RssDistance distance(world.map, {2.0, -100.0});
  KnownScan known;
  RssDistance::Approximate approximate;
  std::vector<RssDistance::Neighbour> nearest;
  const auto points = static_cast<std::uint32_t>(world.map->points().size());
  std::size_t turn = 0;
  for (auto _ : state) {
    world.map->know(world.scans[turn++ % world.scans.size()], known);
    distance.approximate(known, approximate);
    distance.nearest(known, approximate, 1, 0, points, nearest);
    benchmark::DoNotOptimize(nearest.front());
  }
}
BENCHMARK(match_wayfuse)->Args({10000, 500})->Args({100000, 2000})->Unit(benchmark::kMicrosecond);

// --- a session of a preset: a step, and a scan -------------------------------------------------------------------------------

// Whole decibels, as phones report. In a mall every radio speaks with six addresses.
RssScan session_scan(BuildingPoint at, Random& random, std::uint64_t addresses = 1) {
  RssScan scan;
  for (std::uint64_t i = 0; i < 60; ++i) {
    const double d_m = distance_m(at, {7.0 * static_cast<double>(i % 10), 7.0 * static_cast<double>(i / 10)});
    if (d_m >= 25.0) continue;
    const double level_dbm = std::round(-40.0 - 2.0 * d_m + 3.0 * random.normal());
    for (std::uint64_t n = 0; n < addresses; ++n) scan.readings.push_back({Bssid{(i + 1) | n << 42}, level_dbm, {}, 2412, {}, {}});
  }
  return scan;
}

// `planned`: with walls all round and nine shops that nobody surveyed, aisles of 4 m between them.
constexpr BuildingPoint shop_corner(int shop) { return {1.0 + 20.0 * (shop % 3), 1.0 + 13.0 * (shop / 3)}; }
constexpr double kShopWide_m = 16.0, kShopDeep_m = 9.0;

std::shared_ptr<const TrackerFactory> session_pipeline(const char* preset_name, bool planned = false) {
  auto site = std::make_shared<Site>();
  if (planned) {
    const auto box = [](double x, double y, double wide, double high) { return Ring{{x, y}, {x + wide, y}, {x + wide, y + high}, {x, y + high}}; };
    Floor floor;
    floor.outline = {{box(-1.0, -1.0, 60.0, 40.0)}};
    floor.walkable = {floor.outline};
    for (int shop = 0; shop < 9; ++shop) floor.walkable.front().rings.push_back(box(shop_corner(shop).x_m, shop_corner(shop).y_m, kShopWide_m, kShopDeep_m));
    site->floors = {floor};
  }
  Random random(2);
  for (int i = 0; i < 600; ++i) {
    ReferencePoint point;
    point.place.point = {2.0 * (i % 30), 2.0 * (i / 30)};
    const auto inside = [&](int shop) {
      const BuildingPoint in = {point.place.point.x_m - shop_corner(shop).x_m, point.place.point.y_m - shop_corner(shop).y_m};
      return in.x_m > 0.0 && in.x_m < kShopWide_m && in.y_m > 0.0 && in.y_m < kShopDeep_m;
    };
    if (planned && std::ranges::any_of(std::views::iota(0, 9), inside)) continue;
    point.walk = "walk-" + std::to_string(i / 60);
    point.scans = {session_scan(point.place.point, random)};
    point.scans[0].time = PhoneTime{std::chrono::seconds(i)};
    site->survey.push_back(std::move(point));
  }
  return *assemble(*preset(preset_name), site);
}

MotionReport session_step() {
  MotionReport step;
  step.reference = HeadingReference::kTrue;
  step.interval = std::chrono::milliseconds(500);
  step.heading_sigma_rad = 0.1;
  step.steps = 1;
  step.step_length_m = 0.7;
  step.distance_sigma_m = 0.1;
  return step;
}

void session(benchmark::State& state, const char* preset_name, bool scans, std::uint64_t addresses = 1, bool planned = false) {
  const auto tracker = session_pipeline(preset_name, planned)->make_tracker(Random(1));
  Random random(3);
  PhoneTime time{std::chrono::seconds(1000)};
  RssScan scan = session_scan({20, 20}, random, addresses);
  MotionReport step = session_step();
  for (int i = 0; i < 10; ++i) {
    scan.time = time += std::chrono::seconds(2);
    tracker->feed(scan);
  }
  for (auto _ : state) {
    time += std::chrono::milliseconds(500);
    if (scans) {
      scan.time = time;
      tracker->feed(scan);
    } else {
      step.time = time;
      step.heading = step.heading.turned_by(0.5);
      tracker->feed(step);
    }
    benchmark::DoNotOptimize(tracker->position(time));
  }
}
BENCHMARK_CAPTURE(session, p1_step, "p1", false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(session, p1_scan, "p1", true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(session, default_step, "default", false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(session, default_scan, "default", true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(session, default_scan_in_a_mall, "default", true, 6)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(session, default_step_among_walls, "default", false, 1, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(session, default_scan_among_walls, "default", true, 1, true)->Unit(benchmark::kMicrosecond);

// What a walking session holds: its tracker, the copies it may go back to, the evidence of the last seconds.
// Going round in a circle it hears what it should; walking straight on, scans soon contradict the track, and some sessions hold a rival as well.
void session_memory(benchmark::State& state, const char* preset_name, double turn_rad, std::uint64_t addresses = 1) {
  constexpr std::size_t kSessions = 500;
  const auto pipeline = session_pipeline(preset_name);
  std::vector<std::unique_ptr<Timeline>> sessions;
  sessions.reserve(kSessions);
  Random random(3);
  const RssScan heard = session_scan({20, 20}, random, addresses);
  for (auto _ : state) {
    const std::size_t before = mallinfo2().uordblks;
    for (std::size_t i = 0; i < kSessions; ++i) {
      sessions.push_back(std::make_unique<Timeline>(pipeline->make_tracker(Random(i))));
      for (std::uint64_t k = 1; k <= 60; ++k) {  // two steps a second, a scan every three
        MotionReport step = session_step();
        step.heading = step.heading.turned_by(turn_rad * static_cast<double>(k));
        Sample sample{k, step};
        if (k % 7 == 1) sample.body = heard;
        std::visit([&](auto& body) { body.time = PhoneTime{std::chrono::milliseconds(500 * k)}; }, sample.body);
        sessions.back()->take(sample);
        sessions.back()->catch_up();
      }
    }
    state.counters["kB a session"] = static_cast<double>(mallinfo2().uordblks - before) / kSessions / 1000.0;
    sessions.clear();
  }
}
BENCHMARK_CAPTURE(session_memory, default, "default", 0.5)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(session_memory, default_contradicted, "default", 0.0)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(session_memory, default_in_a_mall, "default", 0.5, 6)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(session_memory, default_in_a_mall_contradicted, "default", 0.0, 6)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(session_memory, p1, "p1", 0.5)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace wayfuse
