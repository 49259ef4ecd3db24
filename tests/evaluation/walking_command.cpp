#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/evaluation/commands.hpp"
#include "sdk/src/recording/import/attitude_trial.hpp"
#include "tests/evaluation/datasets/recorded_site.hpp"
#include "sdk/src/recording/import/step_trial.hpp"
#include "tests/evaluation/datasets/split.hpp"
#include "tests/evaluation/motion/walking_score.hpp"
#include "tests/evaluation/progress_bar.hpp"
#include "tests/evaluation/svg_chart.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

constexpr double kLeastWalkM = 20.0;      // shorter ones: a single step is more than 3 %
constexpr double kLeastStretchM = 4.0;

struct WalkingOptions {
  std::string data, format = "oxford", split = "all", json, report;
};

/// What a measurement leaves: rows for JSON and a table, and one picture.
struct Outcome {
  std::string title;
  nlohmann::json rows = nlohmann::json::array();
  std::string picture;
};

// In the folder itself, or in the one of that name in the folder all archives were unpacked into.
std::vector<std::string> csv_files(const std::string& data, const char* archive) {
  const fs::path inner = fs::path(data) / archive, folder = fs::is_directory(inner) ? inner : fs::path(data);
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".csv") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

void left_out(const Fault& fault) { std::fprintf(stderr, "left out: %s\n", to_string(fault).c_str()); }

Result<Outcome> measure_oxford(const WalkingOptions& options) {
  Outcome outcome;
  outcome.title = "Step counts against a foot switch";
  std::map<std::string, std::vector<double>> errors;
  for (const std::string& path : csv_files(options.data, "oxford-steps")) {
    const auto trial = read_oxford_trial(path);
    if (!trial || trial->true_steps.empty() || trial->true_steps.back() <= 0) {
      left_out(trial ? Fault{FaultCode::kMalformed, path, "counts no true step"} : trial.fault());
      continue;
    }
    const int truth = trial->true_steps.back();
    std::vector<StepCount> counts = count_steps(trial->samples);
    if (!trial->hardware_steps.empty() && trial->hardware_steps.back() > 0) counts.push_back({"phone_hardware", trial->hardware_steps.back()});
    for (const StepCount& count : counts) {
      const double error_pct = 100.0 * (count.steps - truth) / truth;
      errors[count.detector].push_back(std::abs(error_pct));
      outcome.rows.push_back({{"detector", count.detector}, {"file", trial->name}, {"steps_true", truth}, {"steps_counted", count.steps},
                              {"error_pct", error_pct}});
    }
  }
  if (errors.empty()) return Fault{FaultCode::kNotFound, options.data, "holds no .csv file that can be read"};
  std::vector<ValueSeries> series;
  for (const auto& [detector, values] : errors) {
    double mean = 0.0;
    for (const double value : values) mean += value / static_cast<double>(values.size());
    outcome.rows.push_back({{"detector", detector}, {"file", "all"}, {"mean_error_pct", mean}, {"worst_error_pct", quantile(values, 1.0)}});
    series.push_back({detector, values});
  }
  outcome.picture = distribution_chart({"Step count error", "error, %", "share of walks"}, series, 5.0);
  return outcome;
}

Result<Outcome> measure_still(const WalkingOptions& options) {
  Outcome outcome;
  outcome.title = "False steps on hand motion without walking";
  std::map<std::string, double> steps;
  std::map<std::string, std::vector<double>> rates;
  double minutes = 0.0;
  const std::vector<std::string> files = csv_files(options.data, "broad");
  ProgressBar progress("still phones", files.size());
  for (const std::string& path : files) {
    const auto trial = read_broad_trial(path);
    if (!trial || trial->samples.empty()) {
      left_out(trial ? Fault{FaultCode::kMalformed, path, "holds no sample"} : trial.fault());
      continue;
    }
    const double length_min = seconds(trial->samples.back().time - trial->samples.front().time) / 60.0;
    minutes += length_min;
    for (const StepCount& count : count_steps(trial->samples)) {
      steps[count.detector] += count.steps;
      rates[count.detector].push_back(count.steps / length_min);
      outcome.rows.push_back({{"detector", count.detector}, {"file", trial->name}, {"false_steps_per_min", count.steps / length_min}});
    }
    progress.advance();
  }
  if (minutes <= 0.0) return Fault{FaultCode::kNotFound, options.data, "holds no .csv file that can be read"};
  std::vector<ValueSeries> series;
  for (const auto& [detector, count] : steps) {
    outcome.rows.push_back({{"detector", detector}, {"file", "all"}, {"false_steps_per_min", count / minutes}});
    series.push_back({detector, rates[detector]});
  }
  outcome.picture = distribution_chart({"False steps", "steps a minute", "share of trials"}, series, 60.0);
  return outcome;
}

bool wanted(const std::string& split, const std::string& id) {
  if (split == "all") return true;
  return (split == "test") == (split_of(id) == Split::kTest);
}

Result<Outcome> measure_ilc20(const WalkingOptions& options) {
  const auto site = read_site(options.data, {});
  if (!site) return site.fault();
  std::vector<RecordedWalk> walks;
  for (const WalkFile& file : site->walks) {
    if (!wanted(options.split, file.id)) continue;
    auto walk = read_walk(file.path, file.floor_origin);
    if (!walk) {
      left_out(walk.fault());
      continue;
    }
    walks.push_back(std::move(walk).value());
  }
  if (walks.empty()) return Fault{FaultCode::kNotFound, options.data, "holds no walk of split " + options.split};
  Outcome outcome;
  outcome.title = "Distance and direction between way points";
  std::vector<ValueSeries> series;
  const std::vector<std::string> estimators = heading_estimator_names();
  ProgressBar progress("walks", walks.size() * estimators.size());
  for (const std::string& estimator : estimators) {
    std::vector<ReckonedWalk> reckoned;
    std::vector<double> distance_pct;
    for (const RecordedWalk& walk : walks) {
      reckoned.push_back(reckon(walk, estimator));
      const ReckonedWalk& r = reckoned.back();
      if (r.true_m >= kLeastWalkM) distance_pct.push_back(100.0 * std::abs(r.reckoned_m / r.true_m - 1.0));
      progress.advance();
    }
    const DirectionErrors errors = direction_errors(reckoned, kLeastStretchM);
    double square = 0.0;
    for (const double e : errors.relative_deg) square += e * e / static_cast<double>(errors.relative_deg.size());
    outcome.rows.push_back({{"estimator", estimator}, {"walks", walks.size()}, {"distance_median_pct", quantile(distance_pct, 0.5)},
                            {"distance_p90_pct", quantile(distance_pct, 0.9)}, {"direction_median_deg", quantile(errors.relative_deg, 0.5)},
                            {"direction_absolute_median_deg", quantile(errors.absolute_deg, 0.5)}, {"relative_heading_rms_deg", std::sqrt(square)}});
    series.push_back({estimator, errors.relative_deg});
  }
  outcome.picture = distribution_chart({"Walking direction between way points, offset removed", "error, degrees", "share of stretches"}, series, 40.0);
  return outcome;
}

// Columns in the order in which they first appear; numbers with two digits.
std::string markdown(const Outcome& outcome) {
  std::vector<std::string> columns;
  for (const auto& row : outcome.rows) {
    for (const auto& [key, _] : row.items()) {
      if (std::find(columns.begin(), columns.end(), key) == columns.end()) columns.push_back(key);
    }
  }
  std::string head = "|", rule = "|", body;
  for (const std::string& column : columns) {
    head += " " + column + " |";
    rule += " --- |";
  }
  for (const auto& row : outcome.rows) {
    body += "|";
    for (const std::string& column : columns) {
      char text[64] = "";
      if (const auto it = row.find(column); it != row.end()) {
        if (it->is_number_float()) std::snprintf(text, sizeof text, "%.2f", it->get<double>());
        else if (it->is_number()) std::snprintf(text, sizeof text, "%lld", static_cast<long long>(it->get<std::int64_t>()));
        else std::snprintf(text, sizeof text, "%s", it->get<std::string>().c_str());
      }
      body += std::string(" ") + text + " |";
    }
    body += "\n";
  }
  return head + "\n" + rule + "\n" + body;
}

int measure_walking(const WalkingOptions& options) {
  const auto outcome = options.format == "oxford" ? measure_oxford(options)
                       : options.format == "ilc20" ? measure_ilc20(options)
                                                   : measure_still(options);
  if (!outcome) {
    std::fprintf(stderr, "wayfuse-eval walking: %s\n", to_string(outcome.fault()).c_str());
    return 2;
  }
  const std::string table = markdown(*outcome);
  std::printf("%s", table.c_str());
  const auto write = [](const fs::path& path, const std::string& content) {
    std::ofstream out(path);
    out << content;
    if (!out) std::fprintf(stderr, "wayfuse-eval walking: %s: cannot be written\n", path.c_str());
    return out.good();
  };
  if (!options.json.empty() &&
      !write(options.json, nlohmann::json{{"format", options.format}, {"rows", outcome->rows}}.dump(1) + "\n")) {
    return 2;
  }
  if (!options.report.empty()) {
    fs::create_directories(options.report);
    const std::string name = "walking-" + options.format;
    if (!write(fs::path(options.report) / (name + ".svg"), outcome->picture) ||
        !write(fs::path(options.report) / (name + ".md"), "# " + outcome->title + "\n\n![" + name + "](" + name + ".svg)\n\n" + table)) {
      return 2;
    }
  }
  return 0;
}

}  // namespace

void add_walking_command(CLI::App& app, std::function<int()>& chosen) {
  auto options = std::make_shared<WalkingOptions>();
  CLI::App* command = app.add_subcommand("walking", "Steps, distance and direction of people on foot.");
  command->add_option("--data", options->data, "folder of recordings; for ilc20 a site folder")->required()->check(CLI::ExistingDirectory);
  command->add_option("--format", options->format, "oxford, ilc20 or broad-still")->check(CLI::IsMember({"oxford", "ilc20", "broad-still"}));
  command->add_option("--split", options->split, "ilc20: all, test or survey walks")->check(CLI::IsMember({"all", "test", "survey"}));
  command->add_option("--json", options->json, "write the rows here");
  command->add_option("--report", options->report, "write Markdown and a picture into this folder");
  command->callback([options, &chosen] { chosen = [options] { return measure_walking(*options); }; });
}

}  // namespace wayfuse
