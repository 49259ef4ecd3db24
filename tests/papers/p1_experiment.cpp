#include <array>
#include <cmath>
#include <map>

#include "tests/evaluation/svg_chart.hpp"
#include "tests/papers/experiment.hpp"
#include "tests/papers/pictures.hpp"
#include "tests/papers/radio_world.hpp"

namespace wayfuse::papers {
namespace {

constexpr double kStepS = 0.5;
constexpr double kSpeedMps = 1.0;
// Three rounds.
const std::vector<BuildingPoint> kWalk = {{5, 5}, {55, 5}, {55, 25}, {5, 25}, {5, 10}, {45, 10}, {45, 20}, {10, 20},
                                          {5, 5}, {55, 5}, {55, 25}, {5, 25}, {5, 10}, {45, 10}, {45, 20}, {10, 20},
                                          {5, 5}, {55, 5}, {55, 25}, {5, 25}, {5, 10}, {45, 10}, {45, 20}, {10, 20}};
const std::vector<BuildingPoint> kTransmitters = {{2, 2}, {58, 3}, {30, 15}, {3, 28}, {57, 27}};
// Two rows of offices along a corridor loop, with a door where the walk passes.
const std::vector<Wall> kWalls = {{{0, 7.5}, {5, 7.5}},      {{7, 7.5}, {50, 7.5}},     {{10, 22.5}, {54, 22.5}}, {{56, 22.5}, {60, 22.5}},
                                  {{15, 12.5}, {40, 12.5}}, {{15, 17.5}, {40, 17.5}}, {{20, 0}, {20, 4}},       {{40, 0}, {40, 4}},
                                  {{20, 26}, {20, 30}},     {{40, 26}, {40, 30}}};

const char* const kFloor = "office floor";

struct Run {
  std::map<std::string, Track> tracks;
  std::vector<BuildingPoint> truth;
};

Run walk(const Presets& presets, std::uint64_t seed) {
  Random random(seed);
  RadioWorld world({.level_at_1m_dbm = -38, .exponent = 2.6, .shadow_db = 1.0, .shadow_length_m = 4.0, .fade_db = 2.5, .wall_db = 3.0,
                    .deaf_below_dbm = -100, .rounding_db = 1.0},
                   kTransmitters, kWalls, random);
  auto site = std::make_shared<Site>();
  site->survey = world.survey(grid({0, 0}, {60, 30}, 5.0), 10, random);
  // 15.8 m by dead reckoning alone needs a heading that starts wrong and drifts: an office's steel bends the compass.
  const double side = random.uniform() < 0.5 ? -1.0 : 1.0, start_error_rad = 0.25 * side, drift_radps = 0.0015 * side;
  const double stride = 1.0 + 0.04 * random.normal();
  const KnownStart known{{kWalk.front(), FloorOrdinal{0}}, 0.5, {}};

  const std::vector<std::pair<std::string, std::string>> systems = {
      {"fused", "p1"}, {"MARG", "dead-reckoning"}};
  std::map<std::string, std::shared_ptr<const TrackerFactory>> factories;
  for (const auto& [system, preset] : systems) factories[system] = pipeline(presets, preset, site);
  // As many neighbours as the fusion hears, weighed as in eq. 3 and, as RADAR does, not weighed.
  factories["WLAN"] = pipeline(presets, "wknn", site, {{"locator", {"wknn", {{"k", 8}}}}});
  factories["RADAR"] = pipeline(presets, "wknn", site, {{"locator", {"knn", {{"k", 8}}}}});
  factories["RADAR, one neighbour"] = pipeline(presets, "nn", site);
  factories["trilateration"] = pipeline(presets, "wknn", site, {{"locator", {"trilateration", {{"online", 0}, {"beyond_m", 0}}}}});
  factories["trilateration, unbounded"] = pipeline(presets, "wknn", site, {{"locator", {"trilateration", {{"online", 0}}}}});
  factories["propagation model"] = pipeline(presets, "wknn", site, {{"locator", {"propagation", {}}}});
  std::map<std::string, std::unique_ptr<Tracker>> trackers;
  for (const auto& [system, factory] : factories) {
    trackers[system] = factory->make_tracker(Random(seed), system == "MARG" ? std::optional(known) : std::nullopt);
  }

  Run run;
  double heading_walk_rad = 0.0;
  for (const Moment& moment : stroll(kWalk, kSpeedMps, kStepS)) {
    heading_walk_rad += 0.006 * random.normal();
    MotionReport motion;
    motion.time = at_s(moment.time_s);
    motion.interval = from_seconds(kStepS);
    motion.heading = Heading::from_radians(moment.heading_rad + start_error_rad + drift_radps * moment.time_s + heading_walk_rad +
                                           0.03 * random.normal());
    motion.heading_sigma_rad = 0.25;
    motion.reference = HeadingReference::kTrue;
    motion.speed_mps = std::max(0.0, kSpeedMps * stride + 0.08 * random.normal());
    motion.distance_sigma_m = 0.1 * kStepS;
    const RssScan scan = world.scan(moment.point, motion.time, random);
    for (auto& [system, tracker] : trackers) {
      tracker->feed(motion);
      tracker->feed(scan);
      run.tracks[system].note(moment.time_s, tracker->position(motion.time), moment.point);
    }
    run.truth.push_back(moment.point);
  }
  return run;
}

// How often a track steps through a wall.
double crossings(const std::vector<BuildingPoint>& points) {
  int count = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    for (const Wall& wall : kWalls) count += crosses(wall, points[i - 1], points[i]);
  }
  return count;
}

// The paper's table in its order: each errs less than the next, and the fusion less than any.
const std::vector<std::array<const char*, 2>> kOrder = {{"fused", "WLAN"}, {"fused", "MARG"}, {"fused", "RADAR"}, {"RADAR", "WLAN"},
                                                        {"WLAN", "propagation model"}, {"propagation model", "trilateration"}, {"trilateration", "MARG"}};

std::vector<Outcome> run(const Presets& presets, std::uint64_t seed) {
  const Run walked = walk(presets, seed);
  std::vector<Outcome> outcomes;
  for (const auto& [system, track] : walked.tracks) outcomes.push_back({kFloor, system, "rmse", track.rmse_m()});
  for (const auto& [less, more] : kOrder) {
    outcomes.push_back({kFloor, less, std::string("rmse against ") + more, walked.tracks.at(less).rmse_m() / walked.tracks.at(more).rmse_m()});
  }
  for (const char* system : {"fused", "MARG", "WLAN"}) outcomes.push_back({kFloor, system, "walls crossed", crossings(walked.tracks.at(system).points)});
  outcomes.push_back({kFloor, "truth", "walls crossed", crossings(walked.truth)});
  return outcomes;
}

std::vector<Drawing> draw(const Presets& presets, std::uint64_t seed) {
  const Run walked = walk(presets, seed);
  PlanPicture plan{"P1: tracks on the office floor", nullptr, {}, {}, false};
  for (const Wall& wall : kWalls) plan.tracks.push_back({plan.tracks.empty() ? "wall" : "", "#888888", {wall.from, wall.to}, 0.4});
  plan.tracks.push_back({"access point", "#7f5539", kTransmitters, 0.6, 1.0, true, false});
  std::vector<ValueSeries> below;
  std::vector<LineSeries> over_time;
  for (const Look& look : std::vector<Look>{{"RADAR", 3}, {"propagation model", 4}, {"trilateration", 5}, {"WLAN", 0, false, false, true}, {"MARG", 1}, {"fused", 2, true}}) {
    const Track& track = walked.tracks.at(look.system);
    below.push_back(shares(look, track));
    if (look.colour > 2) continue;
    plan.tracks.push_back(on_plan(look, track));
    over_time.push_back(by_time(look, track));
  }
  plan.tracks.push_back(on_plan(walked.truth));
  return {{"p1-tracks", plan_picture(plan)},
          {"p1-error-over-time", line_chart({"P1: error over time", "time, s", "error, m"}, over_time)},
          {"p1-error-cdf", distribution_chart({"P1: share of errors below", "error, m", "share"}, below, 20.0)}};
}

}  // namespace

Experiment p1_experiment() {
  return {"P1",
          "WLAN/MARG integrated positioning with data fusion",
          "The paper prints the floor, not the air. Taken: 60 x 30 m, 5 access points, reference points every 5 m with 10 scans each, "
          "exponent 2.6, shadowing 1 dB over 4 m, fading 2.5 dB a reading, walls of 3 dB, whole decibels, two scans a second; three rounds, "
          "691 s, with a phone whose heading is 14 degrees wrong, drifts on by 0.09 degrees a second and wanders, stride off by 4 %. Fading is "
          "such that neither WLAN nor RADAR nor the model method errs by more than in the paper, drift such that MARG errs as there. Fed ready-made are the heading and the speed of every half second, with those errors: the paper's "
          "attitude from accelerometer, gyroscope and magnetometer (eqs. 4-10) does not run here. WLAN is the Euclidean WKNN fix, 8 neighbours there and in the fusion (m is not printed), RADAR "
          "the plain mean of the same (its nearest neighbours, averaged), and beside it the nearest alone. MARG starts at the true place and drifts without bound: its figure is "
          "that of this walk's length. Trilateration is the linear one of P3 eqs. 3-6 with levels that fade anew at every reading; the paper does not say "
          "which it took; solutions off the 60 x 30 m are none, but where it says `unbounded`. Walls are crossed as often as a piece of half a second between two positions cuts one.",
          "The paper's nearest neighbours (RADAR, 3.8 m) beat its weighted ones (WLAN, 3.9 m); ours do not ({office floor|RADAR|rmse against WLAN}): of the same eight "
          "neighbours the weighted mean is the better one, and a single one is worse than either ({office floor|RADAR, one neighbour|rmse} m). Trilateration errs by {office floor|trilateration|rmse} m ({office floor|trilateration, unbounded|rmse} with its solutions off the floor), where the "
          "paper has 5.7: linear equations of five transmitters have no answer to fading, and a worse opponent there says nothing for ours. Fused tracks do cross walls: {office floor|fused|walls crossed} times in 691 m, "
          "where the truth never does, dead reckoning {office floor|MARG|walls crossed} and the fixes {office floor|WLAN|walls crossed} times. Nothing in the paper's formulas knows of a wall, and an error of {office floor|fused|rmse} m "
          "is more than the metre between the walk and the nearest of them.",
          {reaches(kFloor, "fused", "rmse", "m", 1.5),
           reaches(kFloor, "fused", "rmse against WLAN", "ratio", 1.5 / 3.9),
           reaches(kFloor, "fused", "rmse against MARG", "ratio", 1.5 / 15.8),
           beats(kFloor, "fused", "rmse against RADAR", 1.5 / 3.8),
           beats(kFloor, "RADAR", "rmse against WLAN", 3.8 / 3.9),
           beats(kFloor, "WLAN", "rmse against propagation model", 3.9 / 4.9),
           beats(kFloor, "propagation model", "rmse against trilateration", 4.9 / 5.7),
           beats(kFloor, "trilateration", "rmse against MARG", 5.7 / 15.8),
           baseline(kFloor, "WLAN", "rmse", "m", 3.9),
           baseline(kFloor, "MARG", "rmse", "m", 15.8),
           baseline(kFloor, "RADAR", "rmse", "m", 3.8),
           shown(kFloor, "RADAR, one neighbour", "rmse", "m"),
           baseline(kFloor, "propagation model", "rmse", "m", 4.9),
           baseline(kFloor, "trilateration", "rmse", "m", 5.7),
           shown(kFloor, "trilateration, unbounded", "rmse", "m"),
           reaches(kFloor, "fused", "walls crossed", "a walk", 0),
           shown(kFloor, "WLAN", "walls crossed", "a walk"),
           shown(kFloor, "MARG", "walls crossed", "a walk"),
           shown(kFloor, "truth", "walls crossed", "a walk")},
          run, draw};
}

}  // namespace wayfuse::papers
