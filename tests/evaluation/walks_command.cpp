#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <thread>

#include "tests/evaluation/commands.hpp"
#include "tests/evaluation/datasets/split.hpp"
#include "tests/evaluation/named_parts.hpp"
#include "tests/evaluation/walks/attack_plan.hpp"
#include "tests/evaluation/walks/measured.hpp"
#include "tests/evaluation/walks/replay_all.hpp"
#include "tests/evaluation/walks/session_replay.hpp"
#include "tests/evaluation/walks/socket_replay.hpp"
#include "tests/evaluation/walks/walks_report.hpp"

namespace wayfuse {
namespace {

struct WalksOptions {
  std::string data;
  std::vector<std::string> floors;
  std::vector<std::string> pipelines = {"dead-reckoning", "nn", "wknn", "knn-manhattan", "p1", "default"};
  std::string only;
  std::string split = "test";
  int folds = 0;
  std::vector<int> score_folds;
  bool with_test = false;
  bool chain = false;
  bool direct = false;
  bool socket = false;
  std::string server = WAYFUSE_SERVER_PROGRAM;
  double rss_offset_db = 0.0;
  std::vector<double> scan_every_s;
  std::uint64_t seed = 1;
  unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  std::string json;
  std::string report;
  AttackPlan plan;
};

int complain(const Fault& fault) {
  std::fprintf(stderr, "wayfuse-eval walks: %s\n", to_string(fault).c_str());
  return 2;
}

// Another phone hears everything this much louder.
void shift_levels(std::vector<ScoredWalk>& walks, double offset_db) {
  for (ScoredWalk& scored : walks) {
    for (RssScan& scan : scored.walk.scans) {
      for (ScanReading& reading : scan.readings) reading.rss_dbm = std::clamp(reading.rss_dbm + offset_db, -120.0, 0.0);
    }
  }
}

/// A site surveyed with some of its walks, and the ways the others take through it.
struct Surveyed {
  std::unique_ptr<SessionReplay> session;
  std::unique_ptr<DirectReplay> direct;
  std::unique_ptr<SocketReplay> socket;

  const WalkReplay& usual(const WalksOptions& options) const {
    if (options.socket) return *socket;
    return options.direct ? static_cast<const WalkReplay&>(*direct) : *session;
  }
};

Result<Surveyed> survey_with(const WalksOptions& options, const RecordedSite& site, const std::vector<RecordedWalk>& walks,
                             const SessionReplay::Survey& how = {{}, true}) {
  std::fprintf(stderr, "uploading the survey: %zu walks\n", walks.size());
  auto session = SessionReplay::create(site, walks, how);
  if (!session) return session.fault();
  Surveyed surveyed{*std::move(session), nullptr, nullptr};
  surveyed.direct = std::make_unique<DirectReplay>(surveyed.session->site());
  for (const std::string& name : options.pipelines) {
    const bool straight = options.direct || name == "dead-reckoning";
    const auto prepared = straight ? surveyed.direct->prepare(name) : surveyed.session->prepare(name);
    if (!prepared) return prepared.fault();
  }
  if (options.socket) {
    std::fprintf(stderr, "uploading the survey again, to %s\n", options.server.c_str());
    auto made = SocketReplay::create(options.server, site, walks);
    if (!made) return made.fault();
    surveyed.socket = *std::move(made);
  }
  return surveyed;
}

Result<Selection> select(const WalksOptions& options, const RecordedSite& site, const SelectionOptions& selecting, bool first = true) {
  auto selection = select_walks(site, selecting);
  if (!selection) return selection;
  if (first) print_some("left out", selection->complaints);
  if (first) print_some("note", selection->notes);
  std::size_t scored = 0;  // walks, whatever they are chained to
  for (const ScoredWalk& walk : selection->scored) scored += walk.parts.size();
  std::fprintf(stderr, "of %zu walks %zu are scored, %zu survey; the others do neither, as test walks never survey\n", site.walks.size(), scored,
               selection->survey.size());
  if (options.rss_offset_db != 0.0) shift_levels(selection->scored, options.rss_offset_db);
  return selection;
}

std::vector<std::vector<Instant>> instants_of_all(const std::vector<ScoredWalk>& walks, const SurveyCover& cover) {
  std::vector<std::vector<Instant>> instants;
  for (const ScoredWalk& scored : walks) instants.push_back(instants_of(scored.walk, cover));
  return instants;
}

Result<std::vector<PipelineRun>> track(const WalksOptions& options, const Surveyed& surveyed, const ScoredData& data) {
  return replay_all({options.pipelines, options.seed, options.threads}, surveyed.usual(options), *surveyed.direct, data);
}

// What they sensed is not needed once they are tracked, and 443 walks of it are many.
void forget_sensors(AttackedWalks& attacked) {
  for (ScoredWalk& scored : attacked.walks) {
    RecordedWalk& walk = scored.walk;
    walk.motion = {}, walk.attitudes = {}, walk.scans = {};
  }
}

Result<void> attack_with(const WalksOptions& options, const Surveyed& surveyed, AttackedWalks attacked, Measured& measured) {
  std::fprintf(stderr, "attack: %s %s %d\n", attacked.attack.c_str(), attacked.kind.c_str(), attacked.fakes);
  auto runs = track(options, surveyed, {attacked.walks, attacked.instants});
  if (!runs) return runs.fault();
  Measured::Attacked done{{}, *std::move(runs), {}};
  if (attacked.attack == "kidnap") {
    auto there = track(options, surveyed, {switched_on(attacked), attacked.instants});
    if (!there) return there.fault();
    done.switched_on = *std::move(there);
  }
  forget_sensors(attacked);
  done.walks = std::move(attacked);
  measured.attacked.push_back(std::move(done));
  return {};
}

Result<void> attack(const WalksOptions& options, const std::vector<RecordedWalk>& survey, const Surveyed& surveyed, Measured& measured) {
  for (AttackedWalks& attacked : attacks_of(options.plan, measured.data(), survey)) {
    std::vector<AttackedWalks> all;
    if (attacked.attack == "kidnap") {
      for (const double every_s : options.scan_every_s) {
        all.push_back(attacked);
        all.back().walks = throttled(attacked.walks, every_s);
        all.back().scan_every_s = every_s;
      }
    }
    all.insert(all.begin(), std::move(attacked));
    for (AttackedWalks& each : all) {
      if (const auto done = attack_with(options, surveyed, std::move(each), measured); !done) return done;
    }
  }
  return {};
}

// The same walks over a map with misplaced points, with the gate before it and without; and over the clean one without the gate.
Result<void> poison(WalksOptions options, const RecordedSite& site, const std::vector<RecordedWalk>& survey, Measured& measured) {
  options.socket = false;  // the gate is left out in process only
  struct Case { double points, walks; bool gate; };
  const AttackPlan& plan = options.plan;
  for (const Case& each : {Case{0, 0, true}, Case{0, 0, false}, Case{plan.poison, plan.poison_walks, true}, Case{plan.poison, plan.poison_walks, false}}) {
    std::fprintf(stderr, "survey with %.0f %% of its points and %.0f %% of its walks misplaced, gate %s\n", 100 * each.points, 100 * each.walks,
                 each.gate ? "on" : "off");
    SurveyPoison spoil(survey, each.points, each.walks, options.seed);
    const auto surveyed = survey_with(options, site, survey, {std::ref(spoil), each.gate});
    if (!surveyed) return surveyed.fault();
    auto runs = track(options, *surveyed, measured.data());
    if (!runs) return runs.fault();
    PoisonRow counts{{}, each.points, each.walks, each.gate};
    const auto doubts = surveyed->session->doubts();
    counts.misplaced = spoil.moved().size(), counts.doubted = doubts.size(), counts.doubted_rightly = spoil.among(doubts);
    measured.poisoned.push_back({counts, *std::move(runs)});
  }
  return {};
}

Result<Measured> measure_over(const WalksOptions& options, const RecordedSite& site, Selection selection) {
  Measured measured;
  measured.instants = instants_of_all(selection.scored, SurveyCover(selection.survey));
  measured.walks = std::move(selection.scored);
  const auto surveyed = survey_with(options, site, selection.survey);
  if (!surveyed) return surveyed.fault();
  measured.survey_walks = selection.survey.size();
  measured.survey_points = surveyed->session->site()->survey.size();
  auto runs = track(options, *surveyed, measured.data());
  if (!runs) return runs.fault();
  measured.runs = *std::move(runs);
  for (const double every_s : options.scan_every_s) {
    std::fprintf(stderr, "one scan in %g s\n", every_s);
    auto slower = track(options, *surveyed, {throttled(measured.walks, every_s), measured.instants});
    if (!slower) return slower.fault();
    measured.throttled.push_back({every_s, *std::move(slower)});
  }
  if (const auto attacked = attack(options, selection.survey, *surveyed, measured); !attacked) return attacked.fault();
  if (!options.plan.poisons()) return measured;
  if (const auto poisoned = poison(options, site, selection.survey, measured); !poisoned) return poisoned.fault();
  return measured;
}

WalksOutcome outcome_of(const WalksOptions& options, const RecordedSite& site, const Measured& measured) {
  WalksOutcome outcome = summarise_walks(measured.data(), measured.runs, site, options.seed);
  outcome.data = site.name;
  outcome.split = options.only.empty() ? options.split : "only";
  if (options.folds > 0) outcome.split = "folds " + std::to_string(options.folds);
  for (const int fold : options.score_folds) outcome.split += (fold == options.score_folds.front() ? ": " : ", ") + std::to_string(fold);
  if (options.with_test) outcome.split += " and test";
  outcome.chain = options.chain;
  outcome.rss_offset_db = options.rss_offset_db;
  outcome.survey_walks = measured.survey_walks / measured.maps;
  outcome.survey_points = measured.survey_points / measured.maps;
  judge_scan_rates(measured, options.seed, outcome);
  judge_attacks(measured, options.seed, outcome);
  return outcome;
}

// What can leave every question unanswered.
std::string lack_of(const Measured& measured) {
  if (measured.survey_walks == 0) return "no walk surveys: all are scored, test walks, or left out";
  if (measured.survey_points == 0) return "no reading of the survey walks can be used";
  const bool heard = std::ranges::any_of(measured.walks, [](const ScoredWalk& scored) {
    return std::ranges::any_of(scored.walk.scans, [](const RssScan& scan) { return !scan.readings.empty(); });
  });
  return heard ? "" : "no reading of the scored walks can be used";
}

int publish(const WalksOptions& options, const WalksOutcome& outcome, const Measured& measured, const RecordedSite& site, const SurveyCover* cover) {
  if (options.direct) std::printf("DIRECT: straight into the pipelines, without client, codec and session\n");
  std::printf("%s", walks_table(outcome).c_str());
  const std::string lack = lack_of(measured);
  if (!lack.empty()) std::fprintf(stderr, "warning: %s\n", lack.c_str());
  if (!options.json.empty()) {
    std::ofstream out(options.json, std::ios::binary);
    out << walks_json(outcome);
    if (!out.flush()) return complain({FaultCode::kNotFound, options.json, "cannot be written"});
  }
  if (!options.report.empty()) write_walks_report(options.report, outcome, measured.data(), measured.runs, site, cover);
  const bool answered = std::ranges::any_of(outcome.rows, [](const ScoreRow& row) { return row.error.n > 0; });
  return answered ? 0 : complain({FaultCode::kNotFound, "walks", "no pipeline answered anything" + (lack.empty() ? "" : ": " + lack)});
}

// Every survey walk is scored once, over a map of the walks outside its fold, and if asked for every test walk, over a map of all survey
// walks; what comes out is one table over all of them.
int measure_folds(const WalksOptions& options, const RecordedSite& site) {
  std::optional<Measured> all;
  std::string nothing;
  bool first = true;
  const auto measure = [&](SelectionOptions selecting) -> Result<void> {
    selecting.may_be_empty = true;
    auto selection = select(options, site, selecting, first);
    first = false;
    if (!selection) return selection.fault();
    if (selection->scored.empty()) {
      nothing = selection->nothing;
      std::fprintf(stderr, "note: passed over: %s\n", nothing.c_str());
      return {};
    }
    auto measured = measure_over(options, site, *std::move(selection));
    if (!measured) return measured.fault();
    if (all) all->append(*std::move(measured));
    else all = *std::move(measured);
    return {};
  };
  for (int fold = 0; fold < options.folds; ++fold) {
    if (!options.score_folds.empty() && std::ranges::find(options.score_folds, fold) == options.score_folds.end()) continue;
    std::fprintf(stderr, "fold %d of 0..%d\n", fold, options.folds - 1);
    if (const auto done = measure({.chain = options.chain, .only = {}, .folds = options.folds, .fold = fold}); !done) return complain(done.fault());
  }
  if (options.with_test) {
    std::fprintf(stderr, "test walks\n");
    if (const auto done = measure({.chain = options.chain, .only = {}}); !done) return complain(done.fault());
  }
  if (!all && !nothing.empty()) return complain({FaultCode::kNotFound, "walks", nothing});
  if (!all) return complain({FaultCode::kOutOfRange, "--score-folds", "none of them is below --folds"});
  return publish(options, outcome_of(options, site, *all), *all, site, nullptr);
}

int measure_walks(const WalksOptions& options) {
  if (const auto writable = check_targets(options.json, options.report); !writable) return complain(writable.fault());
  if (!std::isfinite(options.rss_offset_db)) return complain({FaultCode::kOutOfRange, "--rss-offset", "is no number of decibels"});
  if (std::ranges::any_of(options.scan_every_s, [](double every_s) { return std::isnan(every_s); }))
    return complain({FaultCode::kOutOfRange, "--scan-every", "is no number of seconds"});
  const auto known = check_pipelines(options.pipelines, options.direct ? AskedOf::kPipelines : AskedOf::kSessions);
  if (!known) return complain(known.fault());
  const auto site = read_site(options.data, options.floors);
  if (!site) return complain(site.fault());
  for (const std::string& complaint : site->complaints) std::fprintf(stderr, "note: %s\n", complaint.c_str());
  if (options.folds > 0) return measure_folds(options, *site);
  SelectionOptions selecting{.development = options.split == "dev", .chain = options.chain, .only = {}};
  if (!options.only.empty()) {
    auto ids = read_ids(options.only);
    if (!ids) return complain(ids.fault());
    selecting.only = *std::move(ids);
  }
  auto selection = select(options, *site, selecting);
  if (!selection) return complain(selection.fault());
  const SurveyCover cover(selection->survey);
  const auto measured = measure_over(options, *site, *std::move(selection));
  if (!measured) return complain(measured.fault());
  return publish(options, outcome_of(options, *site, *measured), *measured, *site, &cover);
}

}  // namespace

void add_walks_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<WalksOptions>();
  CLI::App* command = app.add_subcommand("walks", "Accuracy on recorded walks, surveyed and tracked through the whole system");
  add_site_options(*command, options->data, options->floors);
  command
      ->add_option("--pipelines", options->pipelines,
                   "Presets to compare; the last one is compared with each other walk by walk. With --direct also FILE.json and "
                   "PRESET:role.setting=value+role.setting=value")
      ->delimiter(',')
      ->capture_default_str();
  CLI::Option* only =
      command->add_option("--only", options->only, "Score these walks only: a file of ids, one a line; they never survey, nor do test walks that are not listed");
  CLI::Option* split = add_split_option(*command, options->split);
  CLI::Option* folds = command
      ->add_option("--folds", options->folds,
                   "Cross-validation inside the survey: each of its walks is scored over a map of the other folds' walks; test walks are "
                   "not touched")
      ->check(CLI::Range(2, 100))
      ->excludes(only)
      ->excludes(split);
  command
      ->add_option("--score-folds", options->score_folds, "These folds only, counted from 0: choose on some of them, confirm on the others")
      ->delimiter(',')
      ->check(CLI::Range(0, 99))
      ->needs(folds);
  command->add_flag("--with-test", options->with_test, "After the folds the test walks too, over the whole survey: one table over every walk at hand")
      ->needs(folds);
  command->add_flag("--chain", options->chain, "Score walks that continue each other as one long walk");
  command->add_option("--rss-offset", options->rss_offset_db, "Another phone: dB added to every level of the scored walks")
      ->capture_default_str();
  command
      ->add_option("--scan-every", options->scan_every_s,
                   "Throttled phones beside: seconds from a scan that is heard to the next (comma separated; a phone of today in the foreground: 30)")
      ->delimiter(',')
      ->check(CLI::Range(0.1, 3600.0));
  command->add_option("--seed", options->seed, "Of the trackers and the bootstrap")->capture_default_str();
  command->add_option("--threads", options->threads, "Walks replayed at once; does not change any figure")
      ->check(CLI::Range(1u, 256u))
      ->capture_default_str();
  command->add_flag("--direct", options->direct, "Quick look: straight into the pipelines, without client, codec and session");
  command->add_flag("--socket", options->socket, "Through real sockets, against a wayfused started for it")
      ->excludes("--direct");
  command->add_option("--server", options->server, "The wayfused program for --socket")->capture_default_str();
  add_attack_options(*command, options->plan);
  command->add_option("--json", options->json, "Write the figures to this file");
  command->add_option("--report", options->report, "Write report.md, walks.csv and pictures into this folder");
  command->callback([options, &chosen] { chosen = [options] { return measure_walks(*options); }; });
}

}  // namespace wayfuse
