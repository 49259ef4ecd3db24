#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>

#include "server/quality/access_point_watch.hpp"
#include "tests/evaluation/commands.hpp"
#include "tests/evaluation/datasets/split.hpp"
#include "tests/evaluation/named_parts.hpp"
#include "tests/evaluation/progress_bar.hpp"
#include "tests/evaluation/walks/session_replay.hpp"

namespace wayfuse {
namespace {

struct AccessPointOptions {
  std::string data;
  std::vector<std::string> floors;
  std::string pipeline = "default";
  std::string split = "dev";
  int every = 10;
  double power_db = 12.0;
};

int complain(const Fault& fault) {
  std::fprintf(stderr, "wayfuse-eval access-points: %s\n", to_string(fault).c_str());
  return 2;
}

/// What is changed in the walks' scans: addresses that fall silent, that shout, and pairs that change places.
struct Planted {
  std::set<Bssid> vanished, louder;
  std::map<Bssid, Bssid> swapped;
  double power_db = 0.0;

  void apply(RssScan& scan) const {
    std::erase_if(scan.readings, [&](const ScanReading& reading) { return vanished.contains(reading.bssid); });
    for (ScanReading& reading : scan.readings) {
      if (louder.contains(reading.bssid)) reading.rss_dbm = std::min(0.0, reading.rss_dbm + power_db);
      if (const auto other = swapped.find(reading.bssid); other != swapped.end()) reading.bssid = other->second;
    }
  }
};

using Verdicts = std::map<Bssid, AccessPointRecord>;

/// Replays every walk as a session of its own and lets the watch hear it.
Result<Verdicts> watch_walks(const Selection& selection, const DirectReplay& direct, const std::shared_ptr<const SurveyLevels>& levels,
                             const std::string& pipeline, const Planted& planted) {
  AccessPointWatch watch(levels);
  const SurveyCover cover(selection.survey);
  ProgressBar progress("replaying walks", selection.scored.size());
  std::uint64_t session = 0;
  for (const ScoredWalk& scored : selection.scored) {
    RecordedWalk walk = scored.walk;
    for (RssScan& scan : walk.scans) planted.apply(scan);
    const auto instants = instants_of(walk, cover);
    const auto reply = direct.run(walk, instants, pipeline, fnv1a(walk.id));
    if (!reply) return reply.fault();
    ++session;
    for (const RssScan& scan : walk.scans) {
      const auto at = std::ranges::find(instants, scan.time, &Instant::time);
      if (at == instants.end()) continue;
      const auto& position = reply->at[static_cast<std::size_t>(at - instants.begin())];
      if (position) watch.hear(session, scan, *position, UnixTime(scan.time.time_since_epoch()));
    }
    progress.advance();
  }
  Verdicts verdicts;
  for (AccessPointRecord& record : watch.verdicts({}, {})) verdicts.emplace(record.bssid, record);
  return verdicts;
}

// Of those the unchanged walks say something about: the first third falls silent, and so on; pairs far apart change places.
Planted plant(const std::vector<Bssid>& judged, const SurveyLevels& levels, const AccessPointOptions& options) {
  Planted planted;
  planted.power_db = options.power_db;
  std::vector<Bssid> movers;
  for (std::size_t i = 0; i < judged.size(); i += static_cast<std::size_t>(options.every)) {
    const std::size_t kind = i / static_cast<std::size_t>(options.every) % 3;
    if (kind == 0) planted.vanished.insert(judged[i]);
    if (kind == 1) planted.louder.insert(judged[i]);
    if (kind == 2) movers.push_back(judged[i]);
  }
  const auto place = [&](Bssid bssid) { return levels.where_heard(bssid, -120.0, 1.0, 1).at(0); };
  while (movers.size() >= 2) {
    const Bssid one = movers.back();
    movers.pop_back();
    const auto far = std::ranges::find_if(movers, [&](Bssid other) {
      return place(other).floor == place(one).floor && distance_m(place(other).point, place(one).point) >= 30.0;
    });
    if (far == movers.end()) continue;
    planted.swapped[one] = *far;
    planted.swapped[*far] = one;
    movers.erase(far);
  }
  return planted;
}

int measure_access_points(const AccessPointOptions& options) {
  if (const auto known = check_pipelines({&options.pipeline, 1}, AskedOf::kPipelines); !known) return complain(known.fault());
  const auto site = read_site(options.data, options.floors);
  if (!site) return complain(site.fault());
  const auto selection = select_walks(*site, {options.split == "dev", false, {}});
  if (!selection) return complain(selection.fault());
  auto session = SessionReplay::create(*site, selection->survey);
  if (!session) return complain(session.fault());
  DirectReplay direct((*session)->site());
  if (const auto prepared = direct.prepare(options.pipeline); !prepared) return complain(prepared.fault());
  const auto levels = std::make_shared<const SurveyLevels>((*session)->site()->survey);

  const auto unchanged = watch_walks(*selection, direct, levels, options.pipeline, {});
  if (!unchanged) return complain(unchanged.fault());
  std::vector<Bssid> judged;
  std::map<AccessPointState, int> states;
  for (const auto& [bssid, record] : *unchanged) {
    if (!levels->knows(bssid) || record.heard_sessions < AccessPointWatch::kSessions) continue;
    judged.push_back(bssid);
    states[record.state]++;
  }
  std::printf("%s: %zu walks as sessions, %zu access points surveyed, %zu heard in three sessions and more\n", site->name.c_str(),
              selection->scored.size(), levels->transmitters().size(), judged.size());
  std::printf("nothing planted: ok %d, vanished %d, moved %d, power changed %d\n", states[AccessPointState::kOk], states[AccessPointState::kVanished],
              states[AccessPointState::kMoved], states[AccessPointState::kPowerChanged]);

  const Planted planted = plant(judged, *levels, options);
  const auto changed = watch_walks(*selection, direct, levels, options.pipeline, planted);
  if (!changed) return complain(changed.fault());
  const auto found = [&](const auto& bssids, auto key, std::initializer_list<AccessPointState> right) {
    int hits = 0, distrusted = 0;
    for (const auto& each : bssids) {
      const auto verdict = changed->find(key(each));
      if (verdict == changed->end()) continue;
      hits += std::ranges::find(right, verdict->second.state) != right.end();
      distrusted += verdict->second.distrusted();
    }
    std::printf("planted %zu, named rightly %d, distrusted %d\n", bssids.size(), hits, distrusted);
  };
  const auto itself = [](Bssid bssid) { return bssid; };
  std::printf("vanished: "), found(planted.vanished, itself, {AccessPointState::kVanished});
  std::printf("power %+.0f dB: ", options.power_db), found(planted.louder, itself, {AccessPointState::kPowerChanged});
  std::printf("moved: "), found(planted.swapped, [](const auto& pair) { return pair.first; }, {AccessPointState::kMoved});
  int wrong = 0;
  for (const Bssid bssid : judged) {
    const bool touched = planted.vanished.contains(bssid) || planted.louder.contains(bssid) || planted.swapped.contains(bssid);
    const auto verdict = changed->find(bssid);
    wrong += !touched && verdict != changed->end() && verdict->second.distrusted();
  }
  std::printf("distrusted without cause: %d of %zu\n", wrong, judged.size());
  return 0;
}

}  // namespace

void add_access_points_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<AccessPointOptions>();
  CLI::App* command = app.add_subcommand("access-points", "Access points that vanish, move and change power on recorded walks: what is noticed");
  add_site_options(*command, options->data, options->floors);
  command->add_option("--pipeline", options->pipeline, "Preset")->capture_default_str();
  add_split_option(*command, options->split);
  command->add_option("--every", options->every, "One in this many is changed")->check(CLI::Range(1, 1000))->capture_default_str();
  command->add_option("--power", options->power_db, "Change of power, dB")->capture_default_str();
  command->callback([options, &chosen] { chosen = [options] { return measure_access_points(*options); }; });
}

}  // namespace wayfuse
