#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <thread>

#include "server/quality/metrics.hpp"
#include "tests/evaluation/commands.hpp"
#include "tests/evaluation/datasets/levels_table.hpp"
#include "tests/evaluation/datasets/uji_collection.hpp"
#include "tests/evaluation/named_parts.hpp"
#include "tests/evaluation/progress_bar.hpp"
#include "tests/evaluation/svg_chart.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kUjiTraining = "trainingData.csv";
constexpr int kFloorsABuilding = 100;  // a building's floors in one ordinal: building * 100 + floor

struct FingerprintsOptions {
  std::string data;
  std::string format = "auto";
  std::vector<std::string> training;
  std::vector<std::string> validation;
  std::vector<std::string> locators = {"knn:k=5,exponent=2,floor_dbm=-105", "wknn", "gaussian", "similarity", "radio-field"};
  unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  std::string json;
  std::string report;
};

struct Tables {
  FingerprintTable training;
  FingerprintTable validation;
  std::vector<std::string> parts;  ///< of the collection, a validation scan; empty = it has none
  std::vector<std::string> training_files;
  std::string training_part;       ///< the month's folder, where a collection has some
  double metres_per_unit = 1.0;
};

// One table after the other.
FingerprintTable joined(std::span<FingerprintTable> tables) {
  FingerprintTable all{tables.front().access_points, {}, {}};
  for (FingerprintTable& table : tables) all.scans.insert(all.scans.end(), table.scans.begin(), table.scans.end());
  return all;
}

std::string below(const std::string& folder, const std::string& file) {
  const std::string path = fs::path(file).lexically_relative(folder).generic_string();
  return path.empty() || path.starts_with("..") ? file : path;
}

// Absent = the collection is one of levels tables.
std::optional<UjiFiles> uji_files(const FingerprintsOptions& options) {
  if (options.format == "levels" || (options.format == "auto" && options.training.size() == 2)) return std::nullopt;
  const auto found = find_uji(options.data);
  if (!found && options.training.empty() && options.format == "auto") return std::nullopt;
  UjiFiles files = found.value_or(UjiFiles{(fs::path(options.data) / kUjiTraining).string(), (fs::path(options.data) / "validationData.csv").string()});
  if (!options.training.empty()) files.training = options.training.front();
  if (!options.validation.empty()) files.validation = options.validation.front();
  return files;
}

Result<Tables> read_uji_split(const FingerprintsOptions& options, const UjiFiles& files) {
  auto training = read_uji(files.training);
  if (!training) return training.fault();
  auto validation = read_uji(files.validation);
  if (!validation) return validation.fault();
  if (!number_like(*training, *validation)) {
    return Fault{FaultCode::kOutOfRange, "validation", "other access points than the training table"};
  }
  const auto metres = metres_per_unit(*training, files.training);
  if (!metres) return metres.fault();
  return Tables{*std::move(training), *std::move(validation), {}, {below(options.data, files.training)}, "", *metres};
}

// The files the command line names, else those that name themselves.
Result<LevelsCollection> levels_files(const FingerprintsOptions& options) {
  if (options.training.empty() && options.validation.empty()) {
    auto found = find_levels(options.data);
    if (found || options.format != "auto") return found;
    return Fault{found.fault().code, found.fault().field, found.fault().cause + "; nor trainingData.csv and validationData.csv"};
  }
  if (options.training.size() != 2 || options.validation.size() != 2) {
    return Fault{FaultCode::kMissingField, "training, validation", "levels file and places file expected of both"};
  }
  return LevelsCollection{{{options.training[0], options.training[1], ""}}, {{options.validation[0], options.validation[1], ""}}};
}

Result<Tables> read_levels_split(const FingerprintsOptions& options) {
  const auto files = levels_files(options);
  if (!files) return files.fault();
  std::vector<LevelsFiles> all = files->training;
  all.insert(all.end(), files->test.begin(), files->test.end());
  auto tables = read_levels(all);  // together: floors are counted alike
  if (!tables) return tables.fault();
  const std::size_t split = files->training.size();
  Tables made{joined(std::span(*tables).first(split)), joined(std::span(*tables).subspan(split)), {}, {}, files->training.front().part, 1.0};
  for (const LevelsFiles& each : files->training) made.training_files.push_back(below(options.data, each.levels));
  for (std::size_t i = 0; i < files->test.size(); ++i) {
    made.parts.insert(made.parts.end(), (*tables)[split + i].scans.size(), files->test[i].part);
  }
  return made;
}

FloorOrdinal floor_of(const TabledScan& scan) {
  return {scan.building * kFloorsABuilding + scan.floor.value};
}

// Floors below ground are negative, so that a building's reach from -50 to 49.
int building_of(FloorOrdinal floor) {
  return static_cast<int>(std::floor((floor.value + kFloorsABuilding / 2) / static_cast<double>(kFloorsABuilding)));
}

RssScan scan_of(const TabledScan& tabled) {
  RssScan scan;
  for (const TabledScan::Heard& heard : tabled.heard) {
    scan.readings.push_back({Bssid{heard.access_point + 1u}, heard.rss_dbm, Duration{0}, 0, std::nullopt, std::nullopt});
  }
  return scan;
}

std::vector<ReferencePoint> survey_of(const FingerprintTable& table) {
  std::vector<ReferencePoint> survey;
  for (const TabledScan& tabled : table.scans) {
    ReferencePoint point;
    point.place = {tabled.point, floor_of(tabled)};
    point.scans = {scan_of(tabled)};
    survey.push_back(std::move(point));
  }
  return survey;
}

struct LocatorRun {
  std::string name;
  std::vector<std::optional<Fix>> fixes;
};

struct LocatorScore {
  std::string name;
  std::string part;        ///< empty = the whole collection
  ErrorSummary error;
  std::size_t unanswered = 0;
  double floor_hit = 0.0;
  double building_hit = 0.0;
  Interval mean_interval;
  Interval floor_interval;
  std::vector<double> errors;
};

LocatorRun locate_all(const std::string& name, const LocatorModel& model, const FingerprintTable& table, unsigned threads) {
  LocatorRun run{name, std::vector<std::optional<Fix>>(table.scans.size())};
  ProgressBar progress(name, table.scans.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    const auto locator = model.make();
    for (std::size_t i = next++; i < table.scans.size(); i = next++) {
      run.fixes[i] = locator->locate(scan_of(table.scans[i]));
      progress.advance();
    }
  };
  std::vector<std::jthread> workers;
  for (unsigned t = 1; t < threads; ++t) workers.emplace_back(work);
  work();
  workers.clear();
  return run;
}

// Of all scans, or of one part's.
LocatorScore score_run(const LocatorRun& run, const Tables& tables, const std::string* part = nullptr) {
  const FingerprintTable& table = tables.validation;
  LocatorScore score;
  score.name = run.name;
  if (part) score.part = *part;
  double all = 0.0;
  std::vector<GroupSum> errors, floors;
  std::size_t floor_hits = 0, building_hits = 0;
  for (std::size_t i = 0; i < table.scans.size(); ++i) {
    if (part && tables.parts[i] != *part) continue;
    ++all;
    if (!run.fixes[i]) {
      ++score.unanswered;
      floors.push_back({0.0, 1});
      continue;
    }
    const FloorOrdinal floor = run.fixes[i]->place.floor;
    score.errors.push_back(distance_m(run.fixes[i]->place.point, table.scans[i].point));
    errors.push_back({score.errors.back(), 1});
    const bool hit = floor == floor_of(table.scans[i]);
    floor_hits += hit;
    floors.push_back({hit ? 1.0 : 0.0, 1});
    building_hits += building_of(floor) == table.scans[i].building;
  }
  score.error = summarise(score.errors);
  score.floor_hit = static_cast<double>(floor_hits) / all;  // a scan without an answer is a miss
  score.building_hit = static_cast<double>(building_hits) / all;
  score.mean_interval = bootstrap_mean(errors, Random(1));
  score.floor_interval = bootstrap_mean(floors, Random(1));
  return score;
}

Json row_json(const LocatorScore& score, std::string_view unit, double metres) {
  Json row;
  row["locator"] = score.name;
  if (!score.part.empty()) row["part"] = score.part;
  row["unit"] = unit;
  row["n"] = score.error.n;
  row["mean_m"] = score.error.mean * metres;
  row["rmse_m"] = score.error.rmse * metres;
  row["median_m"] = score.error.median * metres;
  row["p75_m"] = score.error.p75 * metres;
  row["p90_m"] = score.error.p90 * metres;
  row["p95_m"] = score.error.p95 * metres;
  row["floor_hit"] = score.floor_hit;
  row["building_hit"] = score.building_hit;
  row["unanswered"] = score.unanswered;
  row["mean_m_interval"] = {score.mean_interval.low * metres, score.mean_interval.high * metres};
  row["floor_hit_interval"] = {score.floor_interval.low, score.floor_interval.high};
  return row;
}

void write_report(const FingerprintsOptions& options, const std::vector<LocatorScore>& scores, double true_metres) {
  fs::create_directories(options.report);
  std::ofstream out(fs::path(options.report) / "report.md");
  out << "# Fingerprints\n\nEach validation scan alone, against the training scans. Floor: building and floor right; a scan "
         "without an answer is a miss."
         "\n\n| locator | mean (95 %) | true metres | median | p75 | p90 | floor hit % | no answer |\n| --- | ---: | ---: | ---: | ---: | "
         "---: | ---: | ---: |\n";
  char line[300];
  std::vector<ValueSeries> series;
  for (const LocatorScore& s : scores) {
    std::snprintf(line, sizeof line, "| %s | %.2f [%.2f, %.2f] | %.2f | %.2f | %.2f | %.2f | %.1f | %zu |\n", s.name.c_str(),
                  s.error.mean, s.mean_interval.low, s.mean_interval.high, s.error.mean * true_metres, s.error.median,
                  s.error.p75, s.error.p90, 100 * s.floor_hit, s.unanswered);
    out << line;
    series.push_back({s.name, s.errors});
  }
  out << "\n![Errors](cdf.svg)\n";
  std::ofstream(fs::path(options.report) / "cdf.svg") << distribution_chart(
      {"Error of single scans", "error, units of the collection", "share of the scans below"}, series, 30.0);
}

// What leaves nothing to score.
std::string lack_of(const Tables& tables) {
  const auto heard = [](const FingerprintTable& table) { return std::ranges::any_of(table.scans, [](const TabledScan& scan) { return !scan.heard.empty(); }); };
  if (!heard(tables.training)) return "no training scan heard anything";
  return heard(tables.validation) ? "" : "no validation scan heard anything";
}

int measure_fingerprints(const FingerprintsOptions& options) {
  const auto complain = [](const Fault& fault) {
    std::fprintf(stderr, "wayfuse-eval fingerprints: %s\n", to_string(fault).c_str());
    return 2;
  };
  if (const auto writable = check_targets(options.json, options.report); !writable) return complain(writable.fault());
  std::vector<std::pair<const LocatorRow*, PartSettings>> locators;
  for (const std::string& text : options.locators) {
    auto locator = locator_named(text);
    if (!locator) return complain(locator.fault());
    locators.push_back(*std::move(locator));
  }
  const auto files = uji_files(options);
  const auto tables = files ? read_uji_split(options, *files) : read_levels_split(options);
  if (!tables) return complain(tables.fault());
  if (const std::string lack = lack_of(*tables); !lack.empty()) return complain({FaultCode::kMalformed, options.data, lack});
  const std::vector<ReferencePoint> survey = survey_of(tables->training);
  const LocatingSite site{RadioMap::build(survey), survey, {}};
  std::vector<LocatorScore> scores, by_part;
  for (std::size_t i = 0; i < locators.size(); ++i) {
    const auto& [row, settings] = locators[i];
    const auto model = row->prepare(site, settings);
    const LocatorRun run = locate_all(options.locators[i], *model, tables->validation, options.threads);
    scores.push_back(score_run(run, *tables));
    const std::set<std::string> names(tables->parts.begin(), tables->parts.end());
    if (names.size() < 2) continue;
    for (const std::string& part : names) by_part.push_back(score_run(run, *tables, &part));
  }
  const double true_metres = tables->metres_per_unit;
  const bool uji = true_metres != 1.0;
  std::printf("training: %s%s", tables->training_files.front().c_str(), tables->training_files.size() > 1 ? "" : "\n");
  if (tables->training_files.size() > 1) std::printf(" and %zu more files\n", tables->training_files.size() - 1);
  std::printf("%zu training scans, %zu validation scans, %zu access points\n", tables->training.scans.size(),
              tables->validation.scans.size(), tables->training.access_points);
  std::printf("%-36s %7s %-15s %7s %7s %7s %7s  %6s %9s\n", "locator", "mean", "[95 %]", uji ? "metres" : "rmse", "median", "p75",
              "p90", "floor", "no answer");
  Json rows = Json::array();
  for (const LocatorScore& s : scores) {
    std::printf("%-36s %7.2f [%6.2f, %5.2f] %7.2f %7.2f %7.2f %7.2f  %5.1f%% %9zu\n", s.name.c_str(), s.error.mean,
                s.mean_interval.low, s.mean_interval.high, uji ? s.error.mean * true_metres : s.error.rmse, s.error.median,
                s.error.p75, s.error.p90, 100 * s.floor_hit, s.unanswered);
    rows.push_back(row_json(s, uji ? "mercator" : "metre", 1.0));
    if (uji) rows.push_back(row_json(s, "metre", true_metres));
  }
  for (const LocatorScore& s : by_part) {
    std::printf("%-36s %7.2f median %.2f p90 %.2f floor %.1f%%  (%s)\n", s.name.c_str(), s.error.mean, s.error.median, s.error.p90,
                100 * s.floor_hit, s.part.c_str());
    rows.push_back(row_json(s, "metre", 1.0));
  }
  if (!options.json.empty()) {
    std::ofstream out(options.json);
    out << Json{{"data", (fs::path(options.data) / "").parent_path().filename().string()},
                {"training_files", tables->training_files},
                {"training_part", tables->training_part},
                {"rows", rows}}
               .dump(1) << "\n";
    if (!out.flush()) return complain({FaultCode::kNotFound, options.json, "cannot be written"});
  }
  if (!options.report.empty()) write_report(options, scores, true_metres);
  const bool answered = std::ranges::any_of(scores, [](const LocatorScore& score) { return score.error.n > 0; });
  return answered ? 0 : complain({FaultCode::kNotFound, "locators", "none answered any scan"});
}

}  // namespace

void add_fingerprints_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<FingerprintsOptions>();
  CLI::App* command =
      app.add_subcommand("fingerprints", "Accuracy of the locators on single scans of a fingerprint collection");
  command->add_option("--data", options->data, "Folder of the collection")->required();
  command->add_option("--format", options->format, "auto: by the files' names; uji: one CSV with header; levels: tables of levels and tables of x,y,z, found by their names (rss; crd, coordinates; trn, tst)")
      ->check(CLI::IsMember({"auto", "uji", "levels"}))
      ->capture_default_str();
  command
      ->add_option("--training", options->training,
                   "Training file (levels: levels file, then places file), instead of the published names")
      ->expected(1, 2);
  command->add_option("--validation", options->validation, "Validation file, likewise")->expected(1, 2);
  command
      ->add_option("--locators", options->locators,
                   "Locators as name or name:setting=value,setting=value (separated by spaces)")
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Scans located at once; does not change any figure")
      ->check(CLI::Range(1u, 256u))
      ->capture_default_str();
  command->add_option("--json", options->json, "Write the figures to this file");
  command->add_option("--report", options->report, "Write report.md and cdf.svg into this folder");
  command->callback([options, &chosen] { chosen = [options] { return measure_fingerprints(*options); }; });
}

}  // namespace wayfuse
