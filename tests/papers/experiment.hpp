#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/pipeline/tracker.hpp"

namespace wayfuse::papers {

/// One number of one run of an experiment.
struct Outcome {
  std::string situation;           ///< the paper's case, like `exponent jumps`
  std::string system;              ///< like `fused`
  std::string figure;              ///< like `rmse`
  double value = 0.0;
};

/// Whose word a claim is.
enum class Stake {
  kOurs,           ///< the paper's own system, or an order of its table: the presets must keep it
  kBeside,   ///< the same with the paper's words taken otherwise, or against a control the paper does not have
  kBaseline,       ///< what the paper compares with: a worse one would make ours look good
  kShown           ///< nothing is claimed
};

/// What the paper prints, or claims in words, about such a number. Smaller is better in all of them.
struct Claim {
  std::string situation;
  std::string system;
  std::string figure;
  std::string unit;
  std::optional<double> paper;     ///< the paper's own number, or the ratio of two it prints
  std::optional<double> bound;     ///< what ours is held against: the paper's number, or 1 where the paper only says which of two errs less
  Stake stake = Stake::kOurs;

  bool is_order() const { return bound && unit == "ratio" && bound != paper; }
};
/// Ours errs by the paper's figure at most.
Claim reaches(std::string situation, std::string system, std::string figure, std::string unit, double paper, Stake stake = Stake::kOurs);
/// The ratio of two systems' figures stays below 1; `paper` is the paper's ratio where it prints both.
Claim beats(std::string situation, std::string system, std::string figure, std::optional<double> paper = {}, Stake stake = Stake::kOurs);
Claim baseline(std::string situation, std::string system, std::string figure, std::string unit, double paper);
Claim shown(std::string situation, std::string system, std::string figure, std::string unit);

/// A picture of one run, as an SVG document.
struct Drawing {
  std::string name;                ///< a file name without ending
  std::string svg;
};

/// The pipelines that run: the presets, or what is tried in the place of some.
using Presets = std::function<PipelineSpec(const std::string& name)>;
PipelineSpec as_shipped(const std::string& name);

struct Experiment {
  std::string paper;               ///< `P1`
  std::string title;
  std::string assumptions;         ///< what the paper leaves open and what was taken, in plain words
  std::string findings;            ///< what does not hold and why; `{case|system|figure}` stands for that row's mean
  std::vector<Claim> claims;
  std::vector<Outcome> (*run)(const Presets& presets, std::uint64_t seed);
  std::vector<Drawing> (*draw)(const Presets& presets, std::uint64_t seed);
  int seeds = 100;                 ///< runs of a full report
};

const std::vector<Experiment>& experiments();
Experiment p1_experiment();
Experiment p2_experiment();
Experiment p3_experiment();
Experiment p4_experiment();
Experiment p5_experiment();

/// A claim beside what `seeds` runs gave.
struct Row {
  std::string paper;
  Claim claim;
  double mean = 0.0;
  double low = 0.0;                ///< 95 % interval of the mean over seeds
  double high = 0.0;
  int seeds = 0;
  std::optional<bool> holds;       ///< the whole interval is within the bound, or beyond it; absent: the bound lies inside, or there is none
  /// In words: `holds`, `does not hold`, `undecided`; of baselines `baseline as good`, `baseline worse`; empty without a bound.
  std::string verdict() const;
};
/// The findings with their numbers filled in; what names no row stays as it is.
std::string findings(const Experiment& experiment, const std::vector<Row>& rows);
/// As tables print it: ratios finer than what is compared to a paper's two digits.
std::string number(double value, const Claim& claim);
/// Runs seeds first_seed, first_seed + 1, ..; 1..seeds are the ones reported, what an experiment leaves open was chosen on others. An outcome
/// without a claim, or a claim without outcomes, is a bug of the experiment and asserted. `threads` change no figure; `after_each_seed` is called
/// from any of them.
struct Runs {
  int seeds = 30;
  int first_seed = 1;
  unsigned threads = 1;
  Presets presets = as_shipped;
  std::function<void()> after_each_seed = [] {};
};
std::vector<Row> judge(const Experiment& experiment, const Runs& runs);

// --- what the experiments share ---------------------------------------------------------------------------------------------

/// A moment of a simulated walk.
struct Moment {
  double time_s = 0.0;
  BuildingPoint point;
  double heading_rad = 0.0;
};
/// Along a polyline at constant speed, one moment every `dt_s`, the first after one `dt_s`.
std::vector<Moment> stroll(const std::vector<BuildingPoint>& corners, double speed_mps, double dt_s);

PhoneTime at_s(double time_s);
/// A preset, some of its parts replaced, prepared for a site. Asserts that it assembles.
std::shared_ptr<const TrackerFactory> pipeline(const Presets& presets, const std::string& name, std::shared_ptr<const Site> site,
                                               const std::map<std::string, PartChoice>& other_parts = {});

/// Errors of one system along a walk, with its track for the pictures.
struct Track {
  std::vector<double> errors_m;
  std::vector<double> times_s;
  std::vector<BuildingPoint> points;
  void note(double time_s, const std::optional<FusedPosition>& position, BuildingPoint truth);
  double rmse_m() const;
  double mean_m() const;
  double most_m() const;
};

}  // namespace wayfuse::papers
