#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/evaluation/commands.hpp"
#include "tests/evaluation/progress_bar.hpp"
#include "tests/papers/experiment.hpp"

namespace wayfuse {
namespace {

struct PapersOptions {
  int seeds = 30;
  int first_seed = 1;
  std::vector<std::string> only;
  std::string json;
  std::string report;
};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

std::string paper_figure(const papers::Row& row) { return row.claim.paper ? number(*row.claim.paper) : "-"; }

// Whether a row is a promise, and if so whether it is kept.
const char* verdict(const papers::Row& row) {
  if (!row.claim.binding || !row.claim.paper) return "";
  return row.holds ? "holds" : "does not hold";
}

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
                         {"binding", row.claim.binding && row.claim.paper.has_value()},
                         {"paper_figure", nullptr},
                         {"holds", row.holds}};
  if (row.claim.paper) json["paper_figure"] = *row.claim.paper;
  return json;
}

void print(const papers::Experiment& experiment, const std::vector<papers::Row>& rows) {
  std::printf("\n%s  %s\n%-28s %-27s %-26s %9s %19s %8s\n", experiment.paper.c_str(), experiment.title.c_str(), "case", "system", "figure",
              "ours", "95 % of the mean", "paper");
  for (const papers::Row& row : rows) {
    std::printf("%-28s %-27s %-26s %9.2f [%7.2f, %7.2f] %8s  %s\n", row.claim.situation.c_str(), row.claim.system.c_str(),
                (row.claim.figure + (row.claim.unit.empty() ? "" : ", " + row.claim.unit)).c_str(), row.mean, row.low, row.high,
                paper_figure(row).c_str(), verdict(row));
  }
}

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path);
  out << text;
  if (!out) throw std::runtime_error("cannot write " + path.string());
}

std::string markdown(const papers::Experiment& experiment, const std::vector<papers::Row>& rows, const std::vector<papers::Drawing>& drawings) {
  std::string text = "## " + experiment.paper + ": " + experiment.title + "\n\n" + experiment.assumptions +
                     "\n\n| case | system | figure | ours, mean over seeds | 95 % interval | paper | |\n|---|---|---|---|---|---|---|\n";
  for (const papers::Row& row : rows) {
    text += "| " + row.claim.situation + " | " + row.claim.system + " | " + row.claim.figure +
            (row.claim.unit.empty() ? "" : ", " + row.claim.unit) + " | " + number(row.mean) + " | " + number(row.low) + " – " +
            number(row.high) + " | " + paper_figure(row) + " | " + verdict(row) + " |\n";
  }
  for (const papers::Drawing& drawing : drawings) text += "\n![" + drawing.name + "](" + drawing.name + ".svg)\n";
  return text + "\n";
}

int run(const PapersOptions& options) {
  std::vector<papers::Experiment> chosen;
  for (const papers::Experiment& experiment : papers::experiments()) {
    if (options.only.empty() || std::ranges::count(options.only, experiment.paper)) chosen.push_back(experiment);
  }
  if (chosen.empty()) {
    std::fprintf(stderr, "wayfuse-eval papers: --only names none of P1, P2, P3, P4, P5\n");
    return 2;
  }
  nlohmann::json json = nlohmann::json::array();
  std::string report = "# The papers' experiments, theirs beside ours\n\nMeans over " + std::to_string(options.seeds) +
                       " seeds. `holds`: our mean reaches the paper's figure. Opponents' figures are shown beside and bind nothing.\n\n";
  if (!options.report.empty()) std::filesystem::create_directories(options.report);
  for (const papers::Experiment& experiment : chosen) {
    std::vector<papers::Row> rows;
    {
      ProgressBar bar(experiment.paper, static_cast<std::size_t>(options.seeds));
      rows = papers::judge(experiment, options.seeds, [&] { bar.advance(); }, options.first_seed);
    }
    print(experiment, rows);
    for (const papers::Row& row : rows) json.push_back(to_json(row));
    if (options.report.empty()) continue;
    const auto drawings = experiment.draw(1);
    for (const papers::Drawing& drawing : drawings) write(std::filesystem::path(options.report) / (drawing.name + ".svg"), drawing.svg);
    report += markdown(experiment, rows, drawings);
  }
  if (!options.json.empty()) write(options.json, json.dump(2) + "\n");
  if (!options.report.empty()) write(std::filesystem::path(options.report) / "papers.md", report);
  return 0;
}

}  // namespace

void add_papers_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<PapersOptions>();
  CLI::App* command = app.add_subcommand("papers", "Each paper's own experiment, simulated: its table beside ours");
  command->add_option("--seeds", options->seeds, "Runs of each experiment")->check(CLI::Range(2, 1000))->capture_default_str();
  command->add_option("--first-seed", options->first_seed, "The first of them: what is chosen on some seeds is reported on others")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--only", options->only, "Only these papers: P1..P5")->delimiter(',');
  command->add_option("--json", options->json, "Rows as JSON");
  command->add_option("--report", options->report, "Folder for papers.md and the figures as SVG");
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace wayfuse
