#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/evaluation/commands.hpp"
#include "tests/evaluation/motion/attitude_score.hpp"
#include "tests/evaluation/progress_bar.hpp"
#include "tests/evaluation/svg_chart.hpp"

namespace wayfuse {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// Where the trials of Michel et al. were made (Grenoble, 2016), by the world magnetic model: their truth is against true north.
constexpr MagneticField kGrenoble{1.9 * kDegree, 61.6 * kDegree, 47.1};

struct AttitudeOptions {
  std::string data, format = "broad", json, report;
  std::vector<std::string> estimators;
};

/// One line of the answer: an estimator over a group of trials. Mean over trials of each trial's root mean square.
struct Row {
  std::string estimator, group;
  AttitudeError rmse;
  double median_deg = 0.0;   // median over trials of each trial's median error
  double ns_per_sample = 0.0, in_sigma = 0.0, in_two_sigma = 0.0;
  std::size_t trials = 0;
};

Row row_of(const std::string& estimator, const std::string& group, const std::vector<const TrialScore*>& scores) {
  Row row;
  row.estimator = estimator;
  row.group = group;
  row.trials = scores.size();
  std::vector<double> medians;
  const double n = static_cast<double>(scores.size());
  for (const TrialScore* score : scores) {
    row.rmse.total_deg += score->rmse.total_deg / n;
    row.rmse.heading_deg += score->rmse.heading_deg / n;
    row.rmse.inclination_deg += score->rmse.inclination_deg / n;
    row.ns_per_sample += score->ns_per_sample / n;
    row.in_sigma += score->in_sigma / n;
    row.in_two_sigma += score->in_two_sigma / n;
    medians.push_back(score->median_deg);
  }
  std::sort(medians.begin(), medians.end());
  row.median_deg = medians.size() % 2 ? medians[medians.size() / 2] : 0.5 * (medians[medians.size() / 2] + medians[medians.size() / 2 - 1]);
  return row;
}

/// A group: a way to run, over the trials whose name holds a word.
struct Group {
  std::string name, word;
  TrialRun run;
};

std::vector<Group> groups_of(const std::string& format) {
  if (format == "tyrex") {
    TrialRun run;
    run.expected = kGrenoble;
    return {{"all", "", run}, {"clean", "_NoDist_", run}, {"disturbed", "_Dist_", run}};
  }
  TrialRun moving, slow;
  moving.skip_rest = true;
  slow.every = 6;
  return {{"all", "", {}}, {"undisturbed", "undisturbed", {}}, {"disturbed", "_disturbed", {}}, {"attached_magnet", "attached_magnet", {}},
          {"no_rest_start", "", moving}, {"every_6th_sample", "", slow}};
}

Result<std::vector<AttitudeTrial>> read_trials(const AttitudeOptions& options) {
  std::vector<std::string> paths = list_trials(options.data);
  if (paths.empty()) paths = list_trials(options.data + "/" + options.format);  // the folder all archives were unpacked into
  if (paths.empty()) return Fault{FaultCode::kNotFound, options.data, "holds no trial of format " + options.format};
  std::vector<AttitudeTrial> trials;
  ProgressBar progress("reading trials", paths.size());
  for (const std::string& path : paths) {
    auto trial = options.format == "broad" ? read_broad_trial(path) : read_tyrex_trial(path, TyrexField::kCalibrated);
    if (trial) trials.push_back(std::move(trial).value());
    else std::fprintf(stderr, "left out: %s\n", to_string(trial.fault()).c_str());
    progress.advance();
  }
  if (trials.empty()) return Fault{FaultCode::kMalformed, options.data, "holds no trial that can be read"};
  return trials;
}

using Runs = std::vector<TrialScore>;  // one a trial

void print(const std::vector<Row>& rows, const char* which) {
  std::printf("\n%-26s %-18s %8s %8s %8s %8s %6s %6s %6s\n", "estimator", which, "total", "heading", "inclin.", "median", "ns", "in68", "in95");
  for (const Row& row : rows) {
    std::printf("%-26s %-18.18s %8.2f %8.2f %8.2f %8.2f %6.0f %6.2f %6.2f\n", row.estimator.c_str(), row.group.c_str(), row.rmse.total_deg,
                row.rmse.heading_deg, row.rmse.inclination_deg, row.median_deg, row.ns_per_sample, row.in_sigma, row.in_two_sigma);
  }
}

nlohmann::json to_json(const Row& row) {
  return {{"estimator", row.estimator}, {"group", row.group}, {"total_deg", row.rmse.total_deg}, {"heading_deg", row.rmse.heading_deg},
          {"inclination_deg", row.rmse.inclination_deg}, {"median_deg", row.median_deg}, {"ns_per_sample", row.ns_per_sample},
          {"in68", row.in_sigma}, {"in95", row.in_two_sigma}, {"trials", row.trials}};
}

bool write_report(const AttitudeOptions& options, const std::vector<Row>& rows, std::vector<ValueSeries> errors) {
  if (errors.size() > 1) std::rotate(errors.begin(), errors.begin() + 1, errors.end());  // the last line is drawn boldest
  std::filesystem::create_directories(options.report);
  const std::filesystem::path folder = options.report;
  std::ofstream chart(folder / ("attitude-" + options.format + ".svg"));
  chart << distribution_chart({"Attitude error, " + options.format, "total error, degrees", "share of instants"}, errors, 15.0);
  std::ofstream text(folder / ("attitude-" + options.format + ".md"));
  text << "# Attitude, " << options.format << "\n\nMean over trials of the root mean square error in degrees; median = median over trials of the median "
       << "error; ns = time of one feed() in this run; in68, in95 = share of heading errors within one and two stated sigmas.\n\n"
       << "![errors](attitude-" << options.format << ".svg)\n\n"
       << "| estimator | group | trials | total | heading | inclination | median | ns | in68 | in95 |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  char line[256];
  for (const Row& row : rows) {
    std::snprintf(line, sizeof line, "| %s | %s | %zu | %.2f | %.2f | %.2f | %.2f | %.0f | %.2f | %.2f |\n", row.estimator.c_str(), row.group.c_str(),
                  row.trials, row.rmse.total_deg, row.rmse.heading_deg, row.rmse.inclination_deg, row.median_deg, row.ns_per_sample, row.in_sigma,
                  row.in_two_sigma);
    text << line;
  }
  return chart.good() && text.good();
}

void score_group(const Group& group, const std::vector<AttitudeTrial>& trials, const std::vector<NamedEstimator>& estimators, bool with_phone,
                 std::vector<Row>& groups, std::vector<Row>& each, std::vector<ValueSeries>& errors) {
  std::vector<const AttitudeTrial*> chosen;
  for (const AttitudeTrial& trial : trials) {
    if (trial.name.find(group.word) != std::string::npos) chosen.push_back(&trial);
  }
  if (chosen.empty()) return;
  ProgressBar progress(group.name, chosen.size() * estimators.size());
  const auto take = [&](const std::string& name, const Runs& runs) {
    std::vector<const TrialScore*> scores;
    for (const TrialScore& run : runs) {
      if (run.totals_deg.empty()) continue;  // no truth to compare with
      scores.push_back(&run);
      if (group.name == "all") each.push_back(row_of(name, run.trial, {&run}));
    }
    if (scores.empty()) return;
    groups.push_back(row_of(name, group.name, scores));
    if (group.name != "all") return;
    ValueSeries series{name, {}};
    for (const TrialScore* run : scores) {
      for (std::size_t i = 0; i < run->totals_deg.size(); i += 50) series.values.push_back(run->totals_deg[i]);
    }
    errors.push_back(std::move(series));
  };
  for (const NamedEstimator& estimator : estimators) {
    Runs runs;
    for (const AttitudeTrial* trial : chosen) {
      runs.push_back(score(estimator, *trial, group.run));
      progress.advance();
    }
    take(estimator.name, runs);
  }
  if (!with_phone) return;
  Runs own;
  for (const AttitudeTrial* trial : chosen) own.push_back(score_phone(*trial, group.run));
  take("phone", own);
}

int measure_attitude(const AttitudeOptions& options) {
  const auto trials = read_trials(options);
  if (!trials) {
    std::fprintf(stderr, "wayfuse-eval attitude: %s\n", to_string(trials.fault()).c_str());
    return 2;
  }
  std::vector<NamedEstimator> estimators = measured_estimators();
  if (!options.estimators.empty()) {
    std::erase_if(estimators, [&](const NamedEstimator& e) {
      return std::find(options.estimators.begin(), options.estimators.end(), e.name) == options.estimators.end();
    });
  }
  std::vector<Row> groups, each;
  std::vector<ValueSeries> errors;
  for (const Group& group : groups_of(options.format)) {
    score_group(group, *trials, estimators, options.format == "tyrex", groups, each, errors);
  }
  print(each, "trial");
  print(groups, "group");
  std::vector<Row> rows = groups;
  rows.insert(rows.end(), each.begin(), each.end());
  if (!options.json.empty()) {
    nlohmann::json json = nlohmann::json::array();
    for (const Row& row : rows) json.push_back(to_json(row));
    std::ofstream out(options.json);
    out << nlohmann::json{{"format", options.format}, {"rows", json}}.dump(1) << '\n';
    if (!out) {
      std::fprintf(stderr, "wayfuse-eval attitude: %s: cannot be written\n", options.json.c_str());
      return 2;
    }
  }
  if (!options.report.empty() && !write_report(options, rows, errors)) {
    std::fprintf(stderr, "wayfuse-eval attitude: %s: cannot be written\n", options.report.c_str());
    return 2;
  }
  return 0;
}

}  // namespace

void add_attitude_command(CLI::App& app, std::function<int()>& chosen) {
  auto options = std::make_shared<AttitudeOptions>();
  CLI::App* command = app.add_subcommand("attitude", "How well the phone knows how it is turned, against optical truth.");
  command->add_option("--data", options->data, "folder of trials")->required()->check(CLI::ExistingDirectory);
  command->add_option("--format", options->format, "broad or tyrex")->check(CLI::IsMember({"broad", "tyrex"}));
  command->add_option("--estimators", options->estimators, "only these (default: all)")->delimiter(',');
  command->add_option("--json", options->json, "write the rows here");
  command->add_option("--report", options->report, "write Markdown and pictures into this folder");
  command->callback([options, &chosen] { chosen = [options] { return measure_attitude(*options); }; });
}

}  // namespace wayfuse
