#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>

#include "server/quality/accuracy_model.hpp"
#include "server/quality/survey_planner.hpp"
#include "tests/evaluation/commands.hpp"
#include "tests/evaluation/datasets/split.hpp"
#include "tests/evaluation/progress_bar.hpp"
#include "tests/evaluation/walks/session_replay.hpp"

namespace wayfuse {
namespace {

struct ExpectedOptions {
  std::string data;
  std::vector<std::string> floors;
  std::string pipeline = "default";
  std::string split = "dev";
  std::uint64_t seed = 1;
};

int complain(const Fault& fault) {
  std::fprintf(stderr, "wayfuse-eval expected: %s\n", to_string(fault).c_str());
  return 2;
}

/// What was expected where the phone truly was, and what was measured there.
struct Pairs {
  std::vector<double> expected_m;
  std::vector<double> measured_m;
  void add(double expected, double measured) { expected_m.push_back(expected), measured_m.push_back(measured); }
  void print(const char* what) const {
    const auto correlation = rank_correlation(expected_m, measured_m);
    std::printf("%-22s n %6zu   expected median %.2f m   measured median %.2f m   rank correlation %s\n", what, expected_m.size(),
                percentile(expected_m, 0.5), percentile(measured_m, 0.5), correlation ? std::to_string(*correlation).substr(0, 5).c_str() : "-");
  }
  /// A quarter of the instants each, by what was expected.
  void print_quarters() const {
    std::vector<std::size_t> order(expected_m.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return expected_m[i]; });
    for (std::size_t quarter = 0; quarter < 4; ++quarter) {
      std::vector<double> expected, measured;
      for (std::size_t i = quarter * order.size() / 4; i < (quarter + 1) * order.size() / 4; ++i) {
        expected.push_back(expected_m[order[i]]);
        measured.push_back(measured_m[order[i]]);
      }
      std::printf("  quarter %zu: expected median %5.2f m   measured median %5.2f m   mean %5.2f m\n", quarter + 1, percentile(expected, 0.5),
                  percentile(measured, 0.5), mean(measured));
    }
  }
};

std::optional<double> expected_at(const ExpectedAccuracy& accuracy, BuildingPoint point) {
  const auto column = static_cast<int>(std::floor((point.x_m - accuracy.origin_x_m) / accuracy.cell_m));
  const auto row = static_cast<int>(std::floor((point.y_m - accuracy.origin_y_m) / accuracy.cell_m));
  if (column < 0 || row < 0 || column >= accuracy.columns || row >= accuracy.rows) return std::nullopt;
  return accuracy.expected_m[static_cast<std::size_t>(row * accuracy.columns + column)];
}

int measure_expected(const ExpectedOptions& options) {
  const auto site = read_site(options.data, options.floors);
  if (!site) return complain(site.fault());
  const auto selection = select_walks(*site, {options.split == "dev", false, {}});
  if (!selection) return complain(selection.fault());
  std::fprintf(stderr, "uploading the survey: %zu walks\n", selection->survey.size());
  auto session = SessionReplay::create(*site, selection->survey);
  if (!session) return complain(session.fault());
  const auto spec = preset(options.pipeline);
  if (!spec) return complain(spec.fault());
  std::fprintf(stderr, "learning from the survey alone\n");
  const auto model = AccuracyModel::learn((*session)->site(), *spec);
  if (!model) return complain(model.fault());
  std::printf("%s: %s\n", site->name.c_str(), (*model)->basis().c_str());

  std::map<FloorOrdinal, ExpectedAccuracy> floors;
  for (const Floor& floor : site->floors) {
    if (auto accuracy = (*model)->expected(floor.ordinal)) floors.emplace(floor.ordinal, *std::move(accuracy));
  }
  DirectReplay direct((*session)->site());
  if (const auto prepared = direct.prepare(options.pipeline); !prepared) return complain(prepared.fault());
  const SurveyCover cover(selection->survey);
  Pairs all, covered, walks;
  ProgressBar progress("replaying walks", selection->scored.size());
  for (const ScoredWalk& scored : selection->scored) {
    const auto instants = instants_of(scored.walk, cover);
    const auto reply = direct.run(scored.walk, instants, options.pipeline, options.seed ^ fnv1a(scored.walk.id));
    if (!reply) return complain(reply.fault());
    double expected_sum = 0.0, measured_sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < instants.size(); ++i) {
      const auto floor = floors.find(instants[i].truth.floor);
      if (!reply->at[i] || floor == floors.end()) continue;
      const auto expected = expected_at(floor->second, instants[i].truth.point);
      if (!expected) continue;
      const double measured = distance_m(reply->at[i]->place.point, instants[i].truth.point);
      all.add(*expected, measured);
      if (instants[i].covered) covered.add(*expected, measured);
      expected_sum += *expected, measured_sum += measured;
      ++count;
    }
    if (count > 0) walks.add(expected_sum / static_cast<double>(count), measured_sum / static_cast<double>(count));
    progress.advance();
  }
  all.print("instants, ALL");
  covered.print("instants, COV");
  walks.print("walks (means)");
  all.print_quarters();
  for (const Floor& floor : site->floors) {
    const auto plan = plan_survey(**model, floor.ordinal);
    if (!plan || plan->walks.empty()) continue;
    const SurveyPlan::Walk& first = plan->walks.front();
    std::printf("floor %s: median to expect %.2f m; walk %.0f m and it is %.2f m; all %zu walks of the plan: %.2f m\n", floor.label.c_str(),
                plan->median_now_m.value_or(NAN), first.length_m, first.median_after_m, plan->walks.size(), plan->walks.back().median_after_m);
  }
  return 0;
}

}  // namespace

void add_expected_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<ExpectedOptions>();
  CLI::App* command = app.add_subcommand("expected", "Expected accuracy, found from the survey alone, against errors measured on recorded walks");
  add_site_options(*command, options->data, options->floors);
  command->add_option("--pipeline", options->pipeline, "Preset")->capture_default_str();
  add_split_option(*command, options->split);
  command->add_option("--seed", options->seed, "Of the trackers")->capture_default_str();
  command->callback([options, &chosen] { chosen = [options] { return measure_expected(*options); }; });
}

}  // namespace wayfuse
