#include "tests/papers/p3_walks.hpp"

#include <algorithm>
#include <functional>

#include "server/locating/trilateration.hpp"
#include "server/pipeline/fusion_tracker.hpp"
#include "tests/papers/radio_world.hpp"

namespace wayfuse::papers::p3 {
namespace {

constexpr double kStepM = 0.7;
constexpr double kStepS = 0.6;
constexpr int kSteps = 173;
const std::vector<BuildingPoint> kNodes = {{-50, -50}, {0, -50}, {50, -50}, {50, 0}, {50, 50}, {0, 50}, {-50, 50}, {-50, 0}};
constexpr BuildingPoint kStart{30, -30};

// 86 steps north, 87 west: 60 m are no whole number of steps of 0.7 m, so that the corner is at (30, 30.2) and the end at (-30.9, 30.2).
std::vector<Moment> hall_walk() {
  std::vector<Moment> moments;
  for (int step = 1; step <= kSteps; ++step) {
    const int north = std::min(step, 86), west = step - north;
    moments.push_back({step * kStepS, {kStart.x_m - west * kStepM, kStart.y_m + north * kStepM}, west > 0 ? std::numbers::pi : std::numbers::pi / 2});
  }
  return moments;
}

// Steps count from 1.
double exponent(Air air, int step) {
  if (air == Air::kDrifts) return 2.0 + 0.34 * step / kSteps;
  return air == Air::kJumps && step >= 86 ? 2.4 : 2.0;
}

// Parts of preset p3 that a system of the comparison replaces.
using Parts = std::map<std::string, PartChoice>;
PartChoice trilateration(bool learns, double threshold = 0.05) {
  return {"trilateration", {{"online", learns ? 1.0 : 0.0}, {"threshold", threshold}}};
}
PartChoice every_fix(double sigma_m) { return {"fix", {{"sigma_m", sigma_m}}}; }
// As printed: every solution is applied, however far off.
Parts learning(double sigma_m = 20.0, double threshold = 0.05) { return {{"locator", trilateration(true, threshold)}, {"measurement", every_fix(sigma_m)}}; }
Parts plain(double sigma_m = 20.0) { return {{"locator", trilateration(false)}, {"measurement", every_fix(sigma_m)}}; }
// With what the preset adds: solutions more than 50 m outside of the survey are none, fixes more than 4 sigma off the track are not applied.
PartChoice guarded_fix(double sigma_m) { return {"fix", {{"sigma_m", sigma_m}, {"gate_sigmas", 4}}}; }
Parts guarded_learning(double sigma_m) { return {{"measurement", guarded_fix(sigma_m)}}; }
Parts guarded_plain(double sigma_m = 20.0) {
  return {{"locator", {"trilateration", {{"online", 0}, {"beyond_m", 50}}}}, {"measurement", guarded_fix(sigma_m)}};
}
Parts fix_alone() {
  return {{"locator", trilateration(false)}, {"measurement", every_fix(20)}, {"motion", {"still", {}}}, {"filter", {"newest-fix", {}}}, {"resampler", {"systematic", {}}}, {"recovery", {"none", {}}}};
}
Parts steps_alone() { return {{"locator", {"none", {}}}, {"measurement", {"none", {}}}}; }

std::map<std::string, Parts> perturbed(const Sweep& sweep) {
  std::map<std::string, Parts> systems;
  for (const double share : kShares) {
    Parts parts = learning(2.0);
    parts["resampler"] = {"perturbing", {{"share", share}, {"sigma_m", sweep.offset_m}}};
    if (sweep.exact_steps) parts["motion"] = {"steps", {{"heading_sigma_rad", 0}, {"length_share", 0}}};
    systems[share_name(share)] = parts;
  }
  return systems;
}

struct Walk {
  BuildingPoint start;
  std::vector<Moment> moments;     // their headings are what the compass says on average
  double step_m;
  double heading_noise_rad;
  bool states_errors = true;       // false: the phone claims to know its steps and headings exactly
};

// Null where nothing is located.
const TrilaterationLocator* locator_of(const Tracker& tracker) {
  return dynamic_cast<const TrilaterationLocator*>(dynamic_cast<const FusionTracker&>(tracker).locator());
}

// Feeds one walk to each system; `before` may change the air before every step.
Run follow(const Presets& presets, RadioWorld& world, std::shared_ptr<const Site> site, const std::map<std::string, Parts>& systems,
           const Walk& walk, const std::function<void(int)>& before, Random& random, std::uint64_t seed) {
  const KnownStart start{{walk.start, FloorOrdinal{0}}, 0.5, {}};
  std::map<std::string, std::shared_ptr<const TrackerFactory>> factories;
  std::map<std::string, std::unique_ptr<Tracker>> trackers;
  for (const auto& [system, parts] : systems) {
    factories[system] = pipeline(presets, "p3", site, parts);
    trackers[system] = factories[system]->make_tracker(Random(seed), start);
  }
  Run run;
  for (std::size_t i = 0; i < walk.moments.size(); ++i) {
    before(static_cast<int>(i) + 1);
    const Moment& moment = walk.moments[i];
    MotionReport motion;
    motion.time = at_s(moment.time_s);
    motion.interval = from_seconds(kStepS);
    motion.heading = Heading::from_radians(moment.heading_rad + walk.heading_noise_rad * random.normal());
    motion.heading_sigma_rad = walk.states_errors ? walk.heading_noise_rad : 0.0;
    motion.reference = HeadingReference::kTrue;
    motion.steps = 1;
    motion.step_length_m = walk.step_m;
    motion.distance_sigma_m = walk.states_errors ? 0.05 : 0.0;
    const RssScan scan = world.scan(moment.point, motion.time, random);
    for (auto& [system, tracker] : trackers) {
      tracker->feed(motion);
      tracker->feed(scan);
      run.tracks[system].note(moment.time_s, tracker->position(motion.time), moment.point);
      if (const auto* locator = locator_of(*tracker)) run.exponents[system].emplace_back(locator->exponents().begin(), locator->exponents().end());
    }
    run.truth.push_back(moment.point);
  }
  return run;
}

std::shared_ptr<Site> surveyed(const RadioWorld& world, const std::vector<BuildingPoint>& points, Random& random) {
  auto site = std::make_shared<Site>();
  site->survey = world.survey(points, 20, random);
  return site;
}

Run simulate(const Presets& presets, Air air, double noise, const std::map<std::string, Parts>& systems, std::uint64_t seed,
             bool states_errors = true) {
  Random random(seed);
  RadioWorld world({.level_at_1m_dbm = -45, .exponent = 2.0, .fade_db = noise}, kNodes, {}, random);
  const auto site = surveyed(world, grid({-50, -50}, {50, 50}, 10.0), random);
  Run run = follow(presets, world, site, systems, {kStart, hall_walk(), kStepM, noise, states_errors},
                   [&](int step) { world.set_exponent(exponent(air, step)); }, random, seed);
  for (int step = 1; step <= kSteps; ++step) run.true_exponents.push_back(exponent(air, step));
  return run;
}

const std::map<std::string, Parts>& compared() {
  static const std::map<std::string, Parts> systems = {{kRssi, fix_alone()},          {kPdr, steps_alone()}, {kPf, plain()},
                                                       {kPfGuarded, guarded_plain()}, {kOurs, learning()},   {kOursGuarded, {}},
                                                       {kEager, learning(20.0, 0.01)}};
  return systems;
}

const std::map<std::string, Parts>& compared_with_variance() {
  static const std::map<std::string, Parts> systems = {{kPdr, steps_alone()}, {kPf, plain()}, {kOurs, learning()}};
  return systems;
}

}  // namespace

const char* name(Air air) {
  return air == Air::kConstant ? "exponent constant" : air == Air::kDrifts ? "exponent drifts to 2.34" : "exponent jumps to 2.4";
}

std::string share_name(double share) { return std::to_string(static_cast<int>(100 * share + 0.5)) + " % perturbed"; }

Run hall(const Presets& presets, Air air, std::uint64_t seed) { return simulate(presets, air, kDeviation, compared(), seed); }

Run hall_with_variance(const Presets& presets, Air air, std::uint64_t seed) {
  return simulate(presets, air, kRootOfVariance, compared_with_variance(), seed);
}

// 9 x 7 m, a node in each corner, a loop of 8 x 5 m; somebody stands before one node half-way. In a room a compass is wrong all along, and a
// fix tells more than in a hall: it counts with 1 m.
Run room(const Presets& presets, std::uint64_t seed) {
  Random random(seed);
  RadioWorld world({.level_at_1m_dbm = -45, .exponent = 2.2, .shadow_db = 1.0, .shadow_length_m = 3.0, .fade_db = 1.0},
                   {{0, 0}, {9, 0}, {9, 7}, {0, 7}}, {}, random);
  const auto site = surveyed(world, grid({0, 0}, {9, 7}, 1.0), random);
  const std::vector<BuildingPoint> loop = {{0.5, 1}, {8.5, 1}, {8.5, 6}, {0.5, 6}, {0.5, 1}};
  Walk walk{loop.front(), stroll(loop, 0.5 / kStepS, kStepS), 0.5, kDeviation};
  const auto half = static_cast<int>(walk.moments.size() / 2);
  const double compass_rad = 0.15 * random.normal();
  for (Moment& moment : walk.moments) moment.heading_rad += compass_rad;
  return follow(presets, world, site,
                {{kPdr, steps_alone()}, {kPf, plain(1)}, {kPfGuarded, guarded_plain(1)}, {kOurs, learning(1)}, {kOursGuarded, guarded_learning(1)}}, walk,
                [&](int step) { if (step == half + 1) world.block(2, 10.0); }, random, seed);
}

double exponent_error(const Run& run, const std::string& system) {
  double most = 0.0;
  for (std::size_t step = 0; step < run.true_exponents.size(); ++step) {
    for (const double each : run.exponents.at(system)[step]) most = std::max(most, std::abs(each - run.true_exponents[step]));
  }
  return most;
}

std::map<std::string, Track> swept(const Presets& presets, const Sweep& sweep, std::uint64_t seed) {
  return simulate(presets, sweep.air, kDeviation, perturbed(sweep), seed, !sweep.exact_steps).tracks;
}

}  // namespace wayfuse::papers::p3
