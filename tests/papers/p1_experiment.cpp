#include <cmath>
#include <map>

#include "tests/evaluation/svg_chart.hpp"
#include "tests/papers/experiment.hpp"
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
// Two rows of offices along a corridor loop.
const std::vector<Wall> kWalls = {{{0, 7.5}, {50, 7.5}}, {{10, 22.5}, {60, 22.5}}, {{15, 12.5}, {40, 12.5}}, {{15, 17.5}, {40, 17.5}},
                                  {{20, 0}, {20, 5}},    {{40, 0}, {40, 5}},       {{20, 25}, {20, 30}},     {{40, 25}, {40, 30}}};

struct Run {
  std::map<std::string, Track> tracks;
  std::vector<BuildingPoint> truth;
};

Run walk(const Presets& presets, std::uint64_t seed) {
  Random random(seed);
  RadioWorld world({.level_at_1m_dbm = -38, .exponent = 2.6, .shadow_db = 1.0, .shadow_length_m = 4.0, .fade_db = 2.87, .wall_db = 3.0,
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
  factories["trilateration"] = pipeline(presets, "wknn", site, {{"locator", {"trilateration", {{"online", 0}}}}});
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

std::vector<Outcome> run(const Presets& presets, std::uint64_t seed) {
  const Run walked = walk(presets, seed);
  std::vector<Outcome> outcomes;
  for (const auto& [system, track] : walked.tracks) outcomes.push_back({"office floor", system, "rmse", track.rmse_m()});
  const double fused_m = walked.tracks.at("fused").rmse_m();
  outcomes.push_back({"office floor", "fused", "rmse against WLAN", fused_m / walked.tracks.at("WLAN").rmse_m()});
  outcomes.push_back({"office floor", "fused", "rmse against MARG", fused_m / walked.tracks.at("MARG").rmse_m()});
  return outcomes;
}

std::vector<Drawing> draw(const Presets& presets, std::uint64_t seed) {
  const Run walked = walk(presets, seed);
  PlanPicture plan{"P1: tracks on the office floor", nullptr, {}, {}, false};
  std::vector<ValueSeries> errors;
  std::vector<LineSeries> over_time;
  std::size_t colour = 0;
  for (const char* system : {"WLAN", "MARG", "fused"}) {
    const Track& track = walked.tracks.at(system);
    const bool fixes = std::string_view(system) == "WLAN";
    plan.tracks.push_back({system, std::string(series_colour(colour++)), track.points, fixes ? 0.12 : 0.2, fixes ? 0.5 : 1.0, fixes, !fixes});
    LineSeries line{system, {}, false};
    for (std::size_t i = 0; i < track.errors_m.size(); ++i) line.points.push_back({track.times_s[i], track.errors_m[i], track.errors_m[i], track.errors_m[i]});
    over_time.push_back(line);
  }
  plan.tracks.push_back({"truth", "#000000", walked.truth, 0.15});
  for (const auto& [system, track] : walked.tracks) errors.push_back({system, track.errors_m});
  return {{"p1-tracks", plan_picture(plan)},
          {"p1-error-over-time", line_chart({"P1: error over time", "time, s", "error, m"}, over_time)},
          {"p1-error-cdf", distribution_chart({"P1: share of errors below", "error, m", "share"}, errors, 20.0)}};
}

}  // namespace

Experiment p1_experiment() {
  return {"P1",
          "WLAN/MARG integrated positioning with data fusion",
          "The paper prints the floor, not the air. Taken: 60 x 30 m, 5 access points, reference points every 5 m with 10 scans each, "
          "exponent 2.6, shadowing 1 dB over 4 m, fading 2.87 dB a reading, walls of 3 dB, whole decibels, two scans a second; three rounds, "
          "660 s, with a phone whose heading is 14 degrees wrong, drifts on by 0.09 degrees a second and wanders, stride off by 4 %: fading and drift are "
          "such that WLAN and MARG err as in the paper. WLAN is the Euclidean WKNN fix, 8 neighbours there and in the fusion (m is not printed), RADAR "
          "the plain mean of the same (its nearest neighbours, averaged), and beside it the nearest alone. Ours must reach the paper's fused figures; the "
          "opponents' figures are shown beside. MARG drifts without bound: its figure is that of this walk's length. Trilateration is the linear one of "
          "P3 eqs. 3-6 with levels that fade anew at every reading; the paper does not say which it took.",
          "",
          {reaches("office floor", "fused", "rmse", "m", 1.5),
           reaches("office floor", "fused", "rmse against WLAN", "ratio", 1.5 / 3.9),
           reaches("office floor", "fused", "rmse against MARG", "ratio", 1.5 / 15.8),
           baseline("office floor", "WLAN", "rmse", "m", 3.9),
           baseline("office floor", "MARG", "rmse", "m", 15.8),
           baseline("office floor", "RADAR", "rmse", "m", 3.8),
           shown("office floor", "RADAR, one neighbour", "rmse", "m"),
           baseline("office floor", "propagation model", "rmse", "m", 4.9),
           baseline("office floor", "trilateration", "rmse", "m", 5.7)},
          run, draw};
}

}  // namespace wayfuse::papers
