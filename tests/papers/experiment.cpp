#include "tests/papers/experiment.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <ranges>
#include <thread>

namespace wayfuse::papers {
namespace {

// Two-sided 97.5 % point of Student's t for 5 and more degrees of freedom (Hill's expansion to 1/n^2; 0.3 % off at 5).
double student(int degrees) {
  const double z = 1.959964, n = degrees;
  return z + (z * z * z + z) / (4 * n) + (5 * std::pow(z, 5) + 16 * z * z * z + 3 * z) / (96 * n * n);
}

bool same(const Outcome& outcome, const Claim& claim) {
  return outcome.situation == claim.situation && outcome.system == claim.system && outcome.figure == claim.figure;
}

// One list a claim, of its outcomes by seed.
std::vector<std::vector<double>> run_all(const Experiment& experiment, const Runs& runs) {
  std::vector<std::vector<Outcome>> by_seed(static_cast<std::size_t>(runs.seeds));
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < by_seed.size(); i = next++) {
      by_seed[i] = experiment.run(runs.presets, static_cast<std::uint64_t>(runs.first_seed) + i);
      runs.after_each_seed();
    }
  };
  std::vector<std::jthread> workers;
  for (unsigned t = 1; t < runs.threads; ++t) workers.emplace_back(work);
  work();
  workers.clear();
  std::vector<std::vector<double>> values(experiment.claims.size());
  for (const Outcome& outcome : std::views::join(by_seed)) {
    const auto claim = std::ranges::find_if(experiment.claims, [&](const Claim& each) { return same(outcome, each); });
    assert(claim != experiment.claims.end());
    values[static_cast<std::size_t>(claim - experiment.claims.begin())].push_back(outcome.value);
  }
  return values;
}

std::optional<bool> decided(const Row& row) {
  if (!row.claim.bound) return std::nullopt;
  constexpr double kRounding = 1e-9;   // equal runs have a ratio of 1, and their mean may not
  const double bound = *row.claim.bound;
  if (row.claim.is_order() ? row.high < bound - kRounding : row.high <= bound + kRounding) return true;
  if (row.low > bound + kRounding) return false;
  return std::nullopt;
}

}  // namespace

Claim reaches(std::string situation, std::string system, std::string figure, std::string unit, double paper, Stake stake) {
  return {std::move(situation), std::move(system), std::move(figure), std::move(unit), paper, paper, stake};
}

Claim beats(std::string situation, std::string system, std::string figure, std::optional<double> paper, Stake stake) {
  return {std::move(situation), std::move(system), std::move(figure), "ratio", paper, 1.0, stake};
}

Claim baseline(std::string situation, std::string system, std::string figure, std::string unit, double paper) {
  return reaches(std::move(situation), std::move(system), std::move(figure), std::move(unit), paper, Stake::kBaseline);
}

Claim shown(std::string situation, std::string system, std::string figure, std::string unit) {
  return {std::move(situation), std::move(system), std::move(figure), std::move(unit), {}, {}, Stake::kShown};
}

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all = {p1_experiment(), p2_experiment(), p3_experiment(), p4_experiment(), p5_experiment()};
  return all;
}

std::string Row::verdict() const {
  if (!claim.bound) return "";
  if (claim.stake == Stake::kBaseline) return !holds ? "baseline undecided" : *holds ? "baseline as good" : "baseline worse";
  const std::string word = !holds ? "undecided" : *holds ? "holds" : "does not hold";
  return claim.stake == Stake::kBeside ? word + " (beside)" : word;
}

std::string number(double value, const Claim& claim) {
  const bool fine = claim.unit == "ratio" || claim.figure.find("exponent") != std::string::npos || claim.situation.find("sweep") != std::string::npos;
  char text[32];
  std::snprintf(text, sizeof text, fine ? "%.3f" : claim.unit == "%" ? "%.0f" : "%.2f", value);
  return text;
}

std::string findings(const Experiment& experiment, const std::vector<Row>& rows) {
  std::string text = experiment.findings;
  for (auto open = text.find('{'); open != std::string::npos; open = text.find('{', open + 1)) {
    const auto close = text.find('}', open);
    const std::string named = text.substr(open + 1, close - open - 1);
    const auto row = std::ranges::find_if(
        rows, [&](const Row& each) { return each.claim.situation + "|" + each.claim.system + "|" + each.claim.figure == named; });
    if (row != rows.end()) text.replace(open, close + 1 - open, number(row->mean, row->claim));
  }
  return text;
}

std::vector<Row> judge(const Experiment& experiment, const Runs& runs) {
  const auto values = run_all(experiment, runs);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < values.size(); ++i) {
    assert(!values[i].empty());
    Row row{experiment.paper, experiment.claims[i], 0.0, 0.0, 0.0, static_cast<int>(values[i].size()), {}};
    const auto n = static_cast<double>(values[i].size());
    for (const double value : values[i]) row.mean += value / n;
    double squares = 0.0;
    for (const double value : values[i]) squares += (value - row.mean) * (value - row.mean);
    const double half = n > 1 ? student(row.seeds - 1) * std::sqrt(squares / (n - 1) / n) : 0.0;
    row.low = row.mean - half;
    row.high = row.mean + half;
    row.holds = decided(row);
    rows.push_back(row);
  }
  return rows;
}

PhoneTime at_s(double time_s) { return PhoneTime{from_seconds(time_s)}; }

std::vector<Moment> stroll(const std::vector<BuildingPoint>& corners, double speed_mps, double dt_s) {
  std::vector<Moment> moments;
  double ahead_m = speed_mps * dt_s;
  int count = 0;
  for (std::size_t leg = 0; leg + 1 < corners.size(); ++leg) {
    const BuildingPoint a = corners[leg], b = corners[leg + 1];
    const double length_m = distance_m(a, b);
    const double heading_rad = std::atan2(b.y_m - a.y_m, b.x_m - a.x_m);
    for (; ahead_m <= length_m + 1e-9; ahead_m += speed_mps * dt_s) {
      moments.push_back({++count * dt_s, {a.x_m + ahead_m * std::cos(heading_rad), a.y_m + ahead_m * std::sin(heading_rad)}, heading_rad});
    }
    ahead_m -= length_m;
  }
  return moments;
}

PipelineSpec as_shipped(const std::string& name) {
  auto spec = preset(name);
  assert(spec);
  return *std::move(spec);
}

std::shared_ptr<const TrackerFactory> pipeline(const Presets& presets, const std::string& name, std::shared_ptr<const Site> site,
                                               const std::map<std::string, PartChoice>& other_parts) {
  PipelineSpec spec = presets(name);
  for (const auto& [role, part] : other_parts) spec.parts[role] = part;
  auto made = assemble(spec, std::move(site));
  assert(made);
  return *made;
}

void Track::note(double time_s, const std::optional<FusedPosition>& position, BuildingPoint truth) {
  if (!position) return;
  errors_m.push_back(distance_m(position->place.point, truth));
  times_s.push_back(time_s);
  points.push_back(position->place.point);
}

double Track::rmse_m() const {
  double squares = 0.0;
  for (const double error : errors_m) squares += error * error;
  return std::sqrt(squares / static_cast<double>(errors_m.size()));
}

double Track::mean_m() const {
  double sum = 0.0;
  for (const double error : errors_m) sum += error;
  return sum / static_cast<double>(errors_m.size());
}

double Track::most_m() const { return std::ranges::max(errors_m); }

}  // namespace wayfuse::papers
