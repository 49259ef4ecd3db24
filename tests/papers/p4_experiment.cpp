#include <cmath>
#include <map>

#include "server/pipeline/corrector.hpp"
#include "server/pipeline/fusion_tracker.hpp"
#include "tests/evaluation/svg_chart.hpp"
#include "tests/papers/experiment.hpp"
#include "tests/papers/radio_world.hpp"

namespace wayfuse::papers {
namespace {

constexpr int kMeasurements = 80;
constexpr int kTrainingTracks = 24;
const std::vector<BuildingPoint> kCorners = {{-50, -50}, {50, -50}, {50, 50}, {-50, 50}};

// 7 x 7 points over the square without the four corners, where the access points stand: 45 fingerprints.
std::vector<BuildingPoint> fingerprints() {
  std::vector<BuildingPoint> points;
  for (const BuildingPoint point : grid({-50, -50}, {50, 50}, 100.0 / 6.0)) {
    if (std::abs(point.x_m) > 49.0 && std::abs(point.y_m) > 49.0) continue;
    points.push_back(point);
  }
  return points;
}

// Constant velocity with the printed process noise 0.01 diag(0.1, 1, 0.1, 1), in the printed unit: centimetres.
std::vector<BuildingPoint> track(BuildingPoint start, BuildingPoint speed_mps, Random& random) {
  std::vector<BuildingPoint> points;
  for (int k = 0; k < kMeasurements; ++k) {
    start.x_m += speed_mps.x_m + 0.01 * std::sqrt(0.001) * random.normal();
    start.y_m += speed_mps.y_m + 0.01 * std::sqrt(0.001) * random.normal();
    speed_mps.x_m += 0.01 * 0.1 * random.normal();
    speed_mps.y_m += 0.01 * 0.1 * random.normal();
    points.push_back(start);
  }
  return points;
}

const std::map<std::string, PartChoice> kPlain = {{"measurement", {"fix", {{"sigma_m", 10}, {"gate_sigmas", 5}}}},
                                                  {"corrector", {"none", {}}}};
const std::map<std::string, PartChoice> kCorrected = {{"measurement", {"fix", {{"sigma_m", 10}, {"gate_sigmas", 5}}}}};

// Trains on tracks with known truth along the same aisle: starts 3 m and courses 6 degrees (1 sigma) about the printed ones.
std::string trained(const Presets& presets, const RadioWorld& world, std::shared_ptr<const Site> site, Random& random) {
  const auto plain = pipeline(presets, "p4", site, kPlain);
  std::vector<TrainingSample> x, y;
  for (int i = 0; i < kTrainingTracks; ++i) {
    const BuildingPoint start{-1.0 + 3.0 * random.normal(), 0.2 + 3.0 * random.normal()};
    const double course_rad = std::atan2(0.2, 0.02) + 0.1 * random.normal();
    const auto tracker = plain->make_tracker(Random(1), KnownStart{{start, FloorOrdinal{0}}, 0.5, {}});
    int second = 0;
    for (const BuildingPoint truth : track(start, {0.2 * std::cos(course_rad), 0.2 * std::sin(course_rad)}, random)) {
      const PhoneTime time = at_s(++second);
      tracker->feed(world.scan(truth, time, random));
      const auto inputs = dynamic_cast<const FusionTracker&>(*tracker).newest_correction_inputs();
      if (!inputs || second < 10) continue;  // the filter's own transient is not its residual
      const BuildingPoint found = tracker->position(time)->place.point;
      x.push_back({*inputs, truth.x_m - found.x_m});
      y.push_back({*inputs, truth.y_m - found.y_m});
    }
  }
  Corrector corrector;
  corrector.x = train(x, {.iterations = 800, .rate = 0.1}, random);
  corrector.y = train(y, {.iterations = 800, .rate = 0.1}, random);
  corrector.from.walks = kTrainingTracks;
  corrector.from.samples = static_cast<int>(x.size());
  return corrector.to_json();
}

struct Run {
  std::map<std::string, Track> tracks;
  std::vector<BuildingPoint> truth;
};

Run walk(const Presets& presets, std::uint64_t seed) {
  Random random(seed);
  // 30 dBm less 10 dB at either end, free space at 2.4 GHz: -30 dBm at 1 m. The fading makes the fix err by about the printed 10 m.
  RadioWorld world({.level_at_1m_dbm = -30, .exponent = 2.0, .fade_db = 0.6}, kCorners, {}, random);
  auto site = std::make_shared<Site>();
  site->survey = world.survey(fingerprints(), 20, random);
  auto learnt = std::make_shared<Site>(*site);
  learnt->correctors["p4"] = trained(presets, world, site, random);
  const auto nearest = pipeline(presets, "nn", site), plain = pipeline(presets, "p4", site, kPlain), corrected = pipeline(presets, "p4", learnt, kCorrected);
  const KnownStart start{{{-1.0, 0.2}, FloorOrdinal{0}}, 0.5, {}};
  std::map<std::string, std::unique_ptr<Tracker>> trackers;
  trackers["nearest neighbour"] = nearest->make_tracker(Random(seed), start);
  trackers["Kalman filter"] = plain->make_tracker(Random(seed), start);
  trackers["Kalman filter and networks"] = corrected->make_tracker(Random(seed), start);
  Run run;
  for (const BuildingPoint truth : track({-1.0, 0.2}, {0.02, 0.2}, random)) {
    run.truth.push_back(truth);
    const PhoneTime time = at_s(static_cast<double>(run.truth.size()));
    const RssScan scan = world.scan(truth, time, random);
    for (auto& [system, tracker] : trackers) {
      tracker->feed(scan);
      run.tracks[system].note(seconds(time.time_since_epoch()), tracker->position(time), truth);
    }
  }
  return run;
}

double mean_from(const Track& track, std::size_t first) {
  double sum = 0.0;
  for (std::size_t i = first; i < track.errors_m.size(); ++i) sum += track.errors_m[i];
  return sum / static_cast<double>(track.errors_m.size() - first);
}

std::vector<Outcome> run(const Presets& presets, std::uint64_t seed) {
  const Run walked = walk(presets, seed);
  std::vector<Outcome> outcomes;
  for (const auto& [system, track] : walked.tracks) {
    outcomes.push_back({"80 measurements", system, "mean error", track.mean_m()});
    outcomes.push_back({"from measurement 52", system, "mean error", mean_from(track, 51)});
  }
  const auto ratio = [&](std::size_t first) {
    return mean_from(walked.tracks.at("Kalman filter and networks"), first) / mean_from(walked.tracks.at("Kalman filter"), first);
  };
  outcomes.push_back({"80 measurements", "Kalman filter and networks", "mean against Kalman", ratio(0)});
  outcomes.push_back({"from measurement 52", "Kalman filter and networks", "mean against Kalman", ratio(51)});
  return outcomes;
}

std::vector<Drawing> draw(const Presets& presets, std::uint64_t seed) {
  const Run walked = walk(presets, seed);
  std::vector<LineSeries> errors;
  PlanPicture plan{"P4: the track", nullptr, {}, {{"truth", "#000000", walked.truth}}, false};
  std::vector<ValueSeries> shares = {{"nearest neighbour", walked.tracks.at("nearest neighbour").errors_m}};
  std::size_t colour = 0;
  for (const char* system : {"Kalman filter", "Kalman filter and networks"}) {
    const Track& track = walked.tracks.at(system);
    shares.push_back({system, track.errors_m});
    plan.tracks.push_back({system, std::string(series_colour(colour++)), track.points});
    LineSeries line{system, {}, false};
    for (std::size_t i = 0; i < track.errors_m.size(); ++i) {
      line.points.push_back({track.times_s[i], track.errors_m[i], track.errors_m[i], track.errors_m[i]});
    }
    errors.push_back(line);
  }
  return {{"p4-tracks", plan_picture(plan)}, {"p4-error", line_chart({"P4: error by measurement", "measurement", "error, m"}, errors)},
          {"p4-cdf", distribution_chart({"P4: share of errors below", "error, m", "share"}, shares, 10.0)}};
}

}  // namespace

Experiment p4_experiment() {
  const std::string both = "Kalman filter and networks";
  return {"P4",
          "Kalman filter over fingerprint fixes with neural correction",
          "Square, fingerprints, powers, noises and network as printed. Start and speed are taken in centimetres as printed: the walker "
          "covers 16 m of the square, the process noise of the truth likewise in centimetres, the filter's in metres; measurement noise "
          "100 I is the filter's R (10 m an axis); levels fade by 0.6 dB a reading. The filter starts at the true place. The networks are "
          "trained on 24 other tracks along the same aisle (starts 3 m, courses 6 degrees about the printed), 800 iterations at rate 0.1.",
          "",
          {reaches("80 measurements", both, "mean error", "m", 2.5),
           beats("80 measurements", both, "mean against Kalman"),
           shown("80 measurements", "Kalman filter", "mean error", "m"),
           shown("80 measurements", "nearest neighbour", "mean error", "m"),
           reaches("from measurement 52", both, "mean error", "m", 2.5),
           beats("from measurement 52", both, "mean against Kalman"),
           shown("from measurement 52", "Kalman filter", "mean error", "m"),
           shown("from measurement 52", "nearest neighbour", "mean error", "m")},
          run, draw};
}

}  // namespace wayfuse::papers
