#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/evaluation/commands.hpp"
#include "tests/evaluation/named_parts.hpp"
#include "tests/evaluation/progress_bar.hpp"
#include "tests/papers/experiment.hpp"

namespace wayfuse {
namespace {

struct PapersOptions {
  int seeds = 0;                   ///< 0: as many as each experiment says
  papers::Runs runs{.threads = std::max(1u, std::thread::hardware_concurrency())};
  std::vector<std::string> only;
  std::vector<std::string> pipelines;
  std::string json;
  std::string report;
};

const std::string kHead =
    "# The papers' experiments, theirs beside ours\n\nMeans over seeds with their 95 % intervals. `holds`: the whole interval keeps the bound; `does not hold`: the "
    "whole interval breaks it; `undecided`: the bound lies inside. Where a paper prints a number, ours must reach it; where it says that one system errs less than "
    "another, the ratio must stay below 1. `baseline`: what the paper compares with, held against the paper's own figure for it: `worse` does not speak for ours. "
    "`beside`: the same claim with the paper's words or assumptions taken otherwise, or against a control the paper does not have.\n\n";

// The presets, and in the place of some what the command line makes of them.
Result<papers::Presets> presets_of(const std::vector<std::string>& pipelines) {
  std::map<std::string, PipelineSpec> tried;
  for (const std::string& pipeline : pipelines) {
    auto spec = pipeline_named(pipeline);
    if (!spec) return spec.fault();
    if (const auto known = preset(spec->name); !known) return known.fault();
    tried[spec->name] = *std::move(spec);
  }
  return papers::Presets([tried](const std::string& name) {
    const auto found = tried.find(name);
    return found == tried.end() ? papers::as_shipped(name) : found->second;
  });
}

using papers::number;

std::string paper_figure(const papers::Row& row) { return row.claim.paper ? number(*row.claim.paper, row.claim) : "-"; }

std::string condition(const papers::Row& row) {
  if (!row.claim.bound) return "";
  return row.claim.is_order() ? "below 1" : "at most " + number(*row.claim.bound, row.claim);
}

const char* word(papers::Stake stake) {
  switch (stake) {
    case papers::Stake::kOurs: return "ours";
    case papers::Stake::kBeside: return "beside";
    case papers::Stake::kBaseline: return "baseline";
    case papers::Stake::kShown: break;
  }
  return "shown";
}

std::string figure(const papers::Row& row) { return row.claim.figure + (row.claim.unit.empty() ? "" : ", " + row.claim.unit); }

nlohmann::json to_json(const papers::Row& row) {
  nlohmann::json json = {{"paper", row.paper},
                         {"case", row.claim.situation},
                         {"system", row.claim.system},
                         {"figure", row.mean},
                         {"figure_name", row.claim.figure},
                         {"unit", row.claim.unit},
                         {"low", row.low},
                         {"high", row.high},
                         {"seeds", row.seeds},
                         {"stake", word(row.claim.stake)},
                         {"paper_figure", nullptr},
                         {"bound", nullptr},
                         {"verdict", row.verdict()},
                         {"holds", nullptr}};
  if (row.claim.paper) json["paper_figure"] = *row.claim.paper;
  if (row.claim.bound) json["bound"] = *row.claim.bound;
  if (row.holds) json["holds"] = *row.holds;
  return json;
}

void print(const papers::Experiment& experiment, const std::vector<papers::Row>& rows) {
  std::printf("\n%s  %s\n%-34s %-27s %-38s %8s %19s %8s %-13s %s\n", experiment.paper.c_str(), experiment.title.c_str(), "case", "system", "figure",
              "ours", "95 % of the mean", "paper", "holds if", "verdict");
  for (const papers::Row& row : rows) {
    std::printf("%-34s %-27s %-38s %8s [%7s, %7s] %8s %-13s %s\n", row.claim.situation.c_str(), row.claim.system.c_str(),
                figure(row).c_str(), number(row.mean, row.claim).c_str(), number(row.low, row.claim).c_str(),
                number(row.high, row.claim).c_str(), paper_figure(row).c_str(), condition(row).c_str(), row.verdict().c_str());
  }
}

// What of the papers' own claims does not hold or is open, row by row.
std::string missed(const std::vector<papers::Row>& rows) {
  int hold = 0, all = 0;
  std::string text;
  for (const papers::Row& row : rows) {
    if (row.claim.stake != papers::Stake::kOurs) continue;
    ++all;
    if (row.holds == true) ++hold;
    if (row.holds == true) continue;
    text += "- " + row.paper + ", " + row.claim.situation + ": " + row.claim.system + ", " + figure(row) + " " + number(row.mean, row.claim) + " [" +
            number(row.low, row.claim) + ", " + number(row.high, row.claim) + "], paper " + paper_figure(row) + ", holds if " + condition(row) + ": " +
            row.verdict() + "\n";
  }
  return std::to_string(hold) + " of " + std::to_string(all) + " claims hold" + (text.empty() ? ".\n" : "; the others:\n\n" + text);
}

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path);
  out << text;
  if (!out) throw std::runtime_error("cannot write " + path.string());
}

std::string markdown(const papers::Experiment& experiment, const std::vector<papers::Row>& rows, const std::vector<papers::Drawing>& drawings) {
  std::string text = "## " + experiment.paper + ": " + experiment.title + "\n\n" + experiment.assumptions + "\n\n" +
                     papers::findings(experiment, rows) + "\n\n| case | system | figure | ours, mean over " + std::to_string(rows.front().seeds) +
                     " seeds | 95 % interval | paper | holds if | |\n|---|---|---|---|---|---|---|---|\n";
  for (const papers::Row& row : rows) {
    text += "| " + row.claim.situation + " | " + row.claim.system + " | " + figure(row) + " | " + number(row.mean, row.claim) + " | " + number(row.low, row.claim) + " – " +
            number(row.high, row.claim) + " | " + paper_figure(row) + " | " + condition(row) + " | " + row.verdict() + " |\n";
  }
  for (const papers::Drawing& drawing : drawings) text += "\n![" + drawing.name + "](" + drawing.name + ".svg)\n";
  return text + "\n";
}

std::vector<papers::Experiment> chosen_experiments(const std::vector<std::string>& only) {
  std::vector<papers::Experiment> chosen;
  for (const papers::Experiment& experiment : papers::experiments()) {
    if (only.empty() || std::ranges::count(only, experiment.paper)) chosen.push_back(experiment);
  }
  return chosen;
}

int run(const PapersOptions& options) {
  const auto chosen = chosen_experiments(options.only);
  const auto presets = presets_of(options.pipelines);
  if (!presets) {
    std::fprintf(stderr, "wayfuse-eval papers: %s\n", to_string(presets.fault()).c_str());
    return 2;
  }
  papers::Runs runs = options.runs;
  runs.presets = *presets;
  nlohmann::json json = nlohmann::json::array();
  std::vector<papers::Row> all_rows;
  std::string report;
  if (!options.report.empty()) std::filesystem::create_directories(options.report);
  for (const papers::Experiment& experiment : chosen) {
    std::vector<papers::Row> rows;
    runs.seeds = options.seeds ? options.seeds : experiment.seeds;
    {
      ProgressBar bar(experiment.paper, static_cast<std::size_t>(runs.seeds));
      runs.after_each_seed = [&] { bar.advance(); };
      rows = papers::judge(experiment, runs);
    }
    print(experiment, rows);
    for (const papers::Row& row : rows) json.push_back(to_json(row));
    all_rows.insert(all_rows.end(), rows.begin(), rows.end());
    if (options.report.empty()) continue;
    const auto drawings = experiment.draw(runs.presets, 1);
    for (const papers::Drawing& drawing : drawings) write(std::filesystem::path(options.report) / (drawing.name + ".svg"), drawing.svg);
    report += markdown(experiment, rows, drawings);
  }
  std::printf("\n%s", missed(all_rows).c_str());
  if (!options.json.empty()) write(options.json, json.dump(2) + "\n");
  if (!options.report.empty()) write(std::filesystem::path(options.report) / "papers.md", kHead + missed(all_rows) + "\n" + report);
  return 0;
}

}  // namespace

void add_papers_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<PapersOptions>();
  CLI::App* command = app.add_subcommand("papers", "Each paper's own experiment, simulated: its table beside ours");
  command->add_option("--seeds", options->seeds, "Runs of each experiment, instead of 80 (P4) to 1,000 (P2)")->check(CLI::Range(2, 10000));
  command->add_option("--first-seed", options->runs.first_seed, "The first of them: what is chosen on some seeds is reported on others")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--threads", options->runs.threads, "Seeds run at once; does not change any figure")
      ->check(CLI::Range(1u, 256u))
      ->capture_default_str();
  command->add_option("--only", options->only, "Only these papers")->check(CLI::IsMember({"P1", "P2", "P3", "P4", "P5"}))->delimiter(',');
  command->add_option("--pipelines", options->pipelines, "Instead of a preset: PRESET:role.setting=value+role.setting=value, or a FILE.json of its name")->delimiter(',');
  command->add_option("--json", options->json, "Rows as JSON");
  command->add_option("--report", options->report, "Folder for papers.md and the figures as SVG");
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace wayfuse
