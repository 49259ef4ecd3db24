#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>

#include "tests/evaluation/commands.hpp"
#include "tests/evaluation/named_parts.hpp"
#include "tests/evaluation/walks/replay_all.hpp"
#include "tests/evaluation/walks/session_replay.hpp"

namespace wayfuse {
namespace {

struct DevicesOptions {
  std::string data;
  std::vector<std::string> floors;
  std::vector<std::string> pipelines = {"wknn", "default"};
  std::string split = "dev";
  double offset_db = 6.0;
  std::uint64_t seed = 1;
  unsigned threads = std::max(1u, std::thread::hardware_concurrency());
};

int complain(const Fault& fault) {
  std::fprintf(stderr, "wayfuse-eval devices: %s\n", to_string(fault).c_str());
  return 2;
}

/// Every second walk of a survey, and of the two halves the smaller one, as a phone surveys it that hears so much louder, under a name of
/// its own or under the others'. So the phone that is scored surveyed most, and sets the level.
class SecondPhone {
 public:
  SecondPhone(const std::vector<RecordedWalk>& survey, double louder_db, bool named) : louder_db_(louder_db), named_(named) {
    std::size_t scans[2] = {0, 0};
    for (std::size_t walk = 0; walk < survey.size(); ++walk) scans[walk % 2] += survey[walk].scans.size();
    half_ = scans[1] <= scans[0] ? 1 : 0;
  }
  void operator()(std::vector<SurveyBatch>& walk) {
    if (walks_++ % 2 != half_) return;
    for (SurveyBatch& batch : walk) {
      for (ReferencePoint& point : batch.points) {
        if (named_) point.device_model += " II";
        for (RssScan& scan : point.scans) {
          for (ScanReading& reading : scan.readings) reading.rss_dbm = std::clamp(reading.rss_dbm + louder_db_, -120.0, 0.0);
        }
      }
    }
  }

 private:
  const double louder_db_;
  const bool named_;
  std::size_t half_ = 1;
  std::size_t walks_ = 0;
};

struct Case {
  const char* what;
  double louder_db;
  bool named;
};

void print(const Case& each, const ScoredData& data, const PipelineRun& run, const PipelineRun& clean, std::uint64_t seed) {
  const ScoreRow row = score(data, run, Scope::kAll, nullptr, seed);
  const auto against = paired_difference(error_sums(data, clean, Scope::kAll), error_sums(data, run, Scope::kAll), Random(seed));
  std::printf("| %s | %s | %zu | %.2f | %.2f | %.2f | %.1f | %+.2f [%+.2f, %+.2f] |\n", run.pipeline.c_str(), each.what, row.error.n,
              row.error.mean, row.error.median, row.error.p90, 100.0 * row.floor_hit, against.difference, against.interval.low,
              against.interval.high);
}

int measure_devices(const DevicesOptions& options) {
  if (const auto known = check_pipelines(options.pipelines, AskedOf::kPipelines); !known) return complain(known.fault());
  const auto site = read_site(options.data, options.floors);
  if (!site) return complain(site.fault());
  const auto selection = select_walks(*site, {options.split == "dev", false, {}});
  if (!selection) return complain(selection.fault());
  const SurveyCover cover(selection->survey);
  std::vector<std::vector<Instant>> instants;
  for (const ScoredWalk& scored : selection->scored) instants.push_back(instants_of(scored.walk, cover));
  const ScoredData data{selection->scored, instants};
  std::printf("%s: %zu survey walks, every second one by another phone; %zu walks scored\n\n", site->name.c_str(), selection->survey.size(),
              selection->scored.size());
  std::printf("| pipeline | survey | n | mean, m | median | p90 | floor %% | mean against one phone (95 %%) |\n"
              "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  const Case cases[] = {{"one phone", 0.0, false}, {"two alike, named", 0.0, true}, {"louder, named: learnt", options.offset_db, true},
                        {"louder, nameless", options.offset_db, false}};
  std::vector<PipelineRun> clean;
  std::string learnt;
  for (const Case& each : cases) {
    std::fprintf(stderr, "survey: %s\n", each.what);
    auto session = SessionReplay::create(*site, selection->survey, {SecondPhone(selection->survey, each.louder_db, each.named), true});
    if (!session) return complain(session.fault());
    for (const DeviceLevel& device : (*session)->devices()) {
      if (device.standing == DeviceLevel::Standing::kReference) continue;
      char line[200];
      std::snprintf(line, sizeof line, "%s: '%s' hears %+.2f dB louder (%s), by %zu of its %zu points and %zu access points\n", each.what,
                    device.model.c_str(), device.offset_db, std::string(name_of(device.standing)).c_str(), device.places, device.points, device.transmitters);
      learnt += line;
    }
    DirectReplay direct((*session)->site());
    for (const std::string& name : options.pipelines) {
      if (const auto prepared = direct.prepare(name); !prepared) return complain(prepared.fault());
    }
    const auto runs = replay_all({options.pipelines, options.seed, options.threads}, direct, direct, data);
    if (!runs) return complain(runs.fault());
    if (clean.empty()) clean = *runs;
    for (std::size_t r = 0; r < runs->size(); ++r) print(each, data, (*runs)[r], clean[r], options.seed);
    std::fflush(stdout);
  }
  std::printf("\n%s", learnt.c_str());
  return 0;
}

}  // namespace

void add_devices_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<DevicesOptions>();
  CLI::App* command = app.add_subcommand("devices", "A survey by two phones of which one hears louder, with its offset learnt and without");
  add_site_options(*command, options->data, options->floors);
  command->add_option("--pipelines", options->pipelines, "Presets")->delimiter(',')->capture_default_str();
  add_split_option(*command, options->split);
  command->add_option("--offset", options->offset_db, "How much louder the second phone hears, dB")->capture_default_str();
  command->add_option("--seed", options->seed, "Of the trackers and the bootstrap")->capture_default_str();
  command->add_option("--threads", options->threads, "Walks replayed at once; does not change any figure")
      ->check(CLI::Range(1u, 256u))
      ->capture_default_str();
  command->callback([options, &chosen] { chosen = [options] { return measure_devices(*options); }; });
}

}  // namespace wayfuse
