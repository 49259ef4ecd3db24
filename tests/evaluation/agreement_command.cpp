#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/locating/radio_field.hpp"
#include "tests/evaluation/commands.hpp"
#include "tests/evaluation/progress_bar.hpp"
#include "tests/evaluation/walks/agreement.hpp"
#include "tests/evaluation/walks/session_replay.hpp"

namespace wayfuse {
namespace {

constexpr double kMistaken_m = 25.0;  // farther off, either half took one place for another: that is no offset

struct AgreementOptions {
  std::string data;
  std::vector<std::string> floors;
  int folds = 6;
};

int complain(const Fault& fault) {
  std::fprintf(stderr, "wayfuse-eval agreement: %s\n", to_string(fault).c_str());
  return 2;
}

// A radio's addresses all go to one half, the same in each scan and in the survey.
RssScan half_of(const RssScan& scan, bool other) {
  RssScan half = scan;
  std::erase_if(half.readings, [&](const ScanReading& reading) {
    return (RadioNames::key(reading) * 0x9e3779b97f4a7c15u >> 63 != 0) != other;
  });
  return half;
}

std::unique_ptr<Locator> locator_of_half(std::vector<ReferencePoint> survey, bool other) {
  for (ReferencePoint& point : survey) {
    for (RssScan& scan : point.scans) scan = half_of(scan, other);
  }
  return std::make_shared<const RadioField>(survey, RadioFieldSettings{})->make();
}

/// Scans of covered ground, and how many were left out as taken for another place or floor by either half.
struct Heard {
  Agreement agreement;
  std::size_t asked = 0;
  std::size_t mistaken = 0;
};

void hear(const Selection& selection, const std::vector<ReferencePoint>& survey, Heard& heard) {
  const SurveyCover cover(selection.survey);
  const std::unique_ptr<Locator> locators[] = {locator_of_half(survey, false), locator_of_half(survey, true)};
  const auto error = [&](const RecordedWalk& walk, const RssScan& scan) -> std::optional<HalvesOfScan> {
    HalvesOfScan halves;
    for (const bool other : {false, true}) {
      Locator& locator = *locators[other];
      const auto fix = locator.locate(half_of(scan, other));
      if (!fix) return std::nullopt;
      const PhoneTime at = scan.time - locator.heard_before();
      locator.rest();
      const auto truth = walk.truth_at(at);
      if (!truth || !cover.covers({*truth, walk.floor})) return std::nullopt;
      const BuildingPoint off{fix->place.point.x_m - truth->x_m, fix->place.point.y_m - truth->y_m};
      if (!other) ++heard.asked;
      if (fix->place.floor != walk.floor || std::hypot(off.x_m, off.y_m) > kMistaken_m) {
        ++heard.mistaken;
        return std::nullopt;
      }
      halves.heard = at;
      (other ? halves.other : halves.one) = off;
    }
    return halves;
  };
  for (const ScoredWalk& scored : selection.scored) {
    std::vector<HalvesOfScan> scans;
    for (const RssScan& scan : scored.walk.scans) {
      if (const auto halves = error(scored.walk, scan)) scans.push_back(*halves);
    }
    heard.agreement.add(scans);
  }
}

void print(const std::string& site, const Heard& heard) {
  const Agreement& agreement = heard.agreement;
  std::printf("%s: %zu walks, %zu scans of covered ground, %zu left out (either half took them for another floor or for a place over %.0f m off)\n\n", site.c_str(),
              agreement.walks, heard.asked, heard.mistaken, kMistaken_m);
  std::printf("| error of half the radios | variance, m2 | both halves agree on | share |\n| --- | ---: | ---: | ---: |\n");
  const auto row = [](const char* what, const Agreement::Mean& all, const Agreement::Mean& shared) {
    std::printf("| %s | %.1f | %.1f | %.0f %% |\n", what, all.m2(), shared.m2(), all.m2() > 0.0 ? 100.0 * shared.m2() / all.m2() : 0.0);
  };
  row("of a scan", agreement.scan, agreement.scan_shared);
  row("of a walk's mean", agreement.walk, agreement.walk_shared);
  std::printf("\n| scans of one walk, s apart | pairs | agreed on, m2 |\n| ---: | ---: | ---: |\n");
  for (std::size_t lag = 0; lag < Agreement::kLags; ++lag) {
    std::printf("| %.0f | %zu | %.1f |\n", static_cast<double>(lag) * Agreement::kLag_s, agreement.lagged[lag].count, agreement.lagged[lag].m2());
  }
}

int measure_agreement(const AgreementOptions& options) {
  const auto site = read_site(options.data, options.floors);
  if (!site) return complain(site.fault());
  Heard heard;
  ProgressBar progress("folds", static_cast<std::size_t>(options.folds));
  for (int fold = 0; fold < options.folds; ++fold) {
    const auto selection = select_walks(*site, {.only = {}, .folds = options.folds, .fold = fold, .may_be_empty = true});
    if (!selection) return complain(selection.fault());
    auto session = SessionReplay::create(*site, selection->survey);
    if (!session) return complain(session.fault());
    hear(*selection, (*session)->site()->survey, heard);
    progress.advance();
  }
  print(site->name, heard);
  return 0;
}

}  // namespace

void add_agreement_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<AgreementOptions>();
  CLI::App* command = app.add_subcommand("agreement", "What two halves of the radios, located apart, are off by together: error that is no radio's own");
  add_site_options(*command, options->data, options->floors);
  command->add_option("--folds", options->folds, "Each survey walk is heard over a map of the other folds' walks; test walks are not touched")
      ->check(CLI::Range(2, 100))
      ->capture_default_str();
  command->callback([options, &chosen] { chosen = [options] { return measure_agreement(*options); }; });
}

}  // namespace wayfuse
