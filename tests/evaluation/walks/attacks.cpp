#include "tests/evaluation/walks/attacks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "tests/evaluation/datasets/split.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

constexpr double kSamePlace_m = 0.01;          // the store rounds places
constexpr double kElsewhere_m = 40.0;
constexpr double kKidnapped_m = 30.0;
constexpr double kCopied_dbm = -60.0;          // what a copyist finds worth copying
constexpr Duration kFlagWithin = std::chrono::seconds(5);
constexpr Duration kBackWithin = std::chrono::seconds(15);
constexpr Duration kDead = std::chrono::seconds(2);
constexpr Duration kBeforeKidnap = std::chrono::seconds(20);

double distance_to_walk(const RecordedWalk& walk, BuildingPoint point) {
  double least = std::numeric_limits<double>::infinity();
  for (const TruePoint& way : walk.way_points) least = std::min(least, distance_m(way.point, point));
  return least;
}

// Where each radio of the building is loudest, one address for each.
struct Loudest {
  ScanReading reading;
  Place place;
};
std::vector<Loudest> loudest_of(std::span<const RecordedWalk> survey) {
  std::map<std::uint64_t, Loudest> radios;
  for (const RecordedWalk& walk : survey) {
    for (const RssScan& scan : walk.scans) {
      for (const ScanReading& reading : scan.readings) {
        if (reading.rss_dbm < kCopied_dbm) continue;
        const auto truth = walk.truth_at(scan.time - reading.age);
        if (!truth) continue;
        const auto [entry, fresh] = radios.try_emplace(reading.bssid.value & 0xffff'ffff'ffu, Loudest{reading, {*truth, walk.floor}});
        if (!fresh && reading.rss_dbm > entry->second.reading.rss_dbm) entry->second = {reading, {*truth, walk.floor}};
      }
    }
  }
  std::vector<Loudest> all;
  for (const auto& [_, loudest] : radios) all.push_back(loudest);
  return all;
}

std::vector<ScanReading> rogues_for(const RecordedWalk& walk, const std::vector<Loudest>& radios, const FakeSettings& settings, Random& random) {
  std::vector<ScanReading> rogues;
  std::vector<ScanReading> choice;
  for (const Loudest& each : radios) {
    const bool here = each.place.floor == walk.floor;
    if (settings.kind == FakeKind::kElsewhere && here && distance_to_walk(walk, each.place.point) >= kElsewhere_m) choice.push_back(each.reading);
    if (settings.kind == FakeKind::kFloor && !here) choice.push_back(each.reading);
  }
  for (int i = 0; i < settings.fakes; ++i) {
    if (settings.kind == FakeKind::kUnknown) {
      rogues.push_back({Bssid{0x0000'5e00'0000u + (random.bits() & 0xff'ffffu)}, 0.0, {}, 2437, {}, {}});
    } else if (!choice.empty()) {
      const std::size_t at = random.below(choice.size());
      rogues.push_back(choice[at]);
      choice.erase(choice.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }
  return rogues;
}

AttackedWalks copy_of(const ScoredData& data, std::string attack, std::string kind, int fakes) {
  return {std::move(attack), std::move(kind), fakes, 0.0, {data.walks.begin(), data.walks.end()}, {data.instants.begin(), data.instants.end()},
          std::vector<std::optional<PhoneTime>>(data.walks.size())};
}

bool far_apart(const RecordedWalk& a, BuildingPoint at, const RecordedWalk& b, BuildingPoint begins, double least_m) {
  return a.floor != b.floor || distance_m(at, begins) >= least_m;
}

RecordedWalk part_of(const RecordedWalk& walk, PhoneTime from, PhoneTime to, Duration shift) {
  RecordedWalk part = walk;
  const auto cut = [&](auto& list) {
    std::erase_if(list, [&](const auto& each) { return each.time < from || each.time > to; });
    for (auto& each : list) each.time += shift;
  };
  cut(part.motion), cut(part.attitudes), cut(part.scans), cut(part.way_points);
  return part;
}

std::vector<double> errors_from(const std::vector<Instant>& instants, const Answers& answers, PhoneTime from) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    if (instants[i].time >= from && answers[i]) errors.push_back(distance_m(answers[i]->place.point, instants[i].truth.point));
  }
  return errors;
}

struct Error {
  double m = 0.0;
  bool covered = false;
};

// At the last instant within `within` that was answered.
std::optional<Error> error_by(const std::vector<Instant>& instants, const Answers& answers, PhoneTime from, Duration within) {
  std::optional<Error> error;
  bool long_enough = false;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    if (instants[i].time >= from + within) long_enough = true;
    if (instants[i].time < from || instants[i].time > from + within || !answers[i]) continue;
    error = {distance_m(answers[i]->place.point, instants[i].truth.point), instants[i].covered};
  }
  return long_enough ? error : std::nullopt;
}

double p(std::vector<double> values, double share) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : percentile(values, share);
}

FoundBack found_back(const std::vector<Error>& errors, Scope scope) {
  std::vector<double> errors_m;
  for (const Error& error : errors) {
    if (scope == Scope::kAll || error.covered) errors_m.push_back(error.m);
  }
  const auto within = static_cast<double>(std::ranges::count_if(errors_m, [](double error_m) { return error_m < 10.0; }));
  return {errors_m.size(), p(errors_m, 0.95), errors_m.empty() ? std::numeric_limits<double>::quiet_NaN() : within / static_cast<double>(errors_m.size())};
}

}  // namespace

std::string_view name_of(FakeKind kind) {
  return kind == FakeKind::kUnknown ? "unknown" : kind == FakeKind::kElsewhere ? "elsewhere" : "floor";
}

AttackedWalks with_fakes(const ScoredData& data, std::span<const RecordedWalk> survey, const FakeSettings& settings) {
  AttackedWalks attacked = copy_of(data, "fakes", std::string(name_of(settings.kind)), settings.fakes);
  const std::vector<Loudest> radios = loudest_of(survey);
  for (std::size_t w = 0; w < attacked.walks.size(); ++w) {
    RecordedWalk& walk = attacked.walks[w].walk;
    Random random(fnv1a(walk.id) ^ static_cast<std::uint64_t>(settings.fakes * 4 + static_cast<int>(settings.kind)));
    const auto rogues = rogues_for(walk, radios, settings, random);
    if (rogues.size() < static_cast<std::size_t>(settings.fakes)) continue;
    const PhoneTime from = walk.way_points.front().time + from_seconds(settings.from_s);
    for (RssScan& scan : walk.scans) {
      if (scan.time < from) continue;
      for (ScanReading rogue : rogues) {
        std::erase_if(scan.readings, [&](const ScanReading& reading) { return reading.bssid == rogue.bssid; });
        rogue.rss_dbm = std::clamp(std::round(settings.level_dbm + 2.0 * random.normal()), -120.0, 0.0);
        rogue.age = from_seconds(0.2 + 0.8 * random.uniform());
        if (scan.readings.size() == 512) scan.readings.pop_back();
        scan.readings.push_back(rogue);
      }
      if (!attacked.began[w]) attacked.began[w] = scan.time;
    }
  }
  return attacked;
}

AttackedWalks with_replay(const ScoredData& data, bool live, double from_s) {
  AttackedWalks attacked = copy_of(data, "replay", live ? "live" : "frozen", 0);
  for (std::size_t w = 0; w < attacked.walks.size(); ++w) {
    RecordedWalk& walk = attacked.walks[w].walk;
    const PhoneTime from = walk.way_points.front().time + from_seconds(from_s);
    const RecordedWalk* donor = nullptr;
    for (std::size_t k = 1; k < data.walks.size() && !donor; ++k) {
      const RecordedWalk& other = data.walks[(w + k) % data.walks.size()].walk;
      if (other.floor != walk.floor || distance_to_walk(walk, other.way_points.front().point) >= kElsewhere_m) donor = &other;
    }
    if (!donor) continue;
    std::vector<RssScan> played;
    for (const RssScan& scan : donor->scans) {
      if (scan.time >= donor->way_points.front().time && scan.readings.size() >= 10) played.push_back(scan);
    }
    if (played.empty()) continue;
    std::size_t next = 0;
    for (RssScan& scan : walk.scans) {
      if (scan.time < from) continue;
      scan.readings = played[live ? next++ % played.size() : 0].readings;
      if (!attacked.began[w]) attacked.began[w] = scan.time;
    }
  }
  return attacked;
}

AttackedWalks kidnapped(const ScoredData& data, bool mid) {
  AttackedWalks attacked{"kidnap", mid ? "mid" : "start", 0, 0.0, {}, {}, {}};
  for (std::size_t w = 0; w < data.walks.size(); ++w) {
    const RecordedWalk& second = data.walks[w].walk;
    const PhoneTime second_begins =
        mid ? second.way_points.front().time + from_seconds(0.5 * second.duration_s()) : second.way_points.front().time;
    const auto begins = second.truth_at(second_begins);
    for (std::size_t k = 1; k < data.walks.size() && begins; ++k) {
      const RecordedWalk& first = data.walks[(w + k) % data.walks.size()].walk;
      const PhoneTime first_ends = mid ? first.way_points.front().time + from_seconds(0.5 * first.duration_s())
                                       : std::min(first.way_points.front().time + kBeforeKidnap, first.way_points.back().time);
      const auto ends = first.truth_at(first_ends);
      if (!ends || !far_apart(first, *ends, second, *begins, kKidnapped_m)) continue;
      RecordedWalk walk = part_of(first, PhoneTime::min(), first_ends, Duration{0});
      const Duration shift = first_ends + kDead - second_begins;
      const RecordedWalk after = part_of(second, second_begins, PhoneTime::max(), shift);
      const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
      append(walk.motion, after.motion), append(walk.scans, after.scans), append(walk.way_points, after.way_points);
      walk.floor = second.floor;
      walk.id = second.id;
      std::vector<Instant> instants;
      for (Instant instant : data.instants[w]) {
        if (instant.time < second_begins) continue;
        instant.time += shift;
        instants.push_back(instant);
      }
      attacked.walks.push_back({std::move(walk), {first.id, second.id}});
      attacked.instants.push_back(std::move(instants));
      attacked.began.push_back(first_ends + kDead);
      break;
    }
  }
  return attacked;
}

std::vector<ScoredWalk> switched_on(const AttackedWalks& kidnapped) {
  std::vector<ScoredWalk> walks;
  for (std::size_t w = 0; w < kidnapped.walks.size(); ++w) {
    const ScoredWalk& carried = kidnapped.walks[w];
    walks.push_back({part_of(carried.walk, *kidnapped.began[w], PhoneTime::max(), Duration{0}), {carried.walk.id}});
  }
  return walks;
}

AttackRow score_attack(const AttackedWalks& attacked, const PipelineRun& run, const ScoredData& data, const PipelineRun& clean) {
  AttackRow row{run.pipeline, attacked.attack, attacked.kind, attacked.fakes, attacked.scan_every_s};
  std::vector<double> errors, clean_errors;
  std::vector<Error> at15, clean_at15;
  std::size_t flagged = 0;
  for (std::size_t w = 0; w < attacked.walks.size(); ++w) {
    const auto& instants = attacked.instants[w];
    if (!attacked.began[w] || instants.empty() || instants.back().time < *attacked.began[w] + kFlagWithin) continue;
    ++row.walks;
    bool seen = false;
    for (std::size_t i = 0; i < instants.size(); ++i) {
      const bool soon = instants[i].time >= *attacked.began[w] && instants[i].time <= *attacked.began[w] + kFlagWithin;
      seen = seen || (soon && run.walks[w][i] && run.walks[w][i]->integrity == Integrity::kSuspect);
    }
    flagged += seen;
    std::ranges::copy(errors_from(instants, run.walks[w], *attacked.began[w]), std::back_inserter(errors));
    if (const auto error = error_by(instants, run.walks[w], *attacked.began[w], kBackWithin)) at15.push_back(*error);
    // Its unattacked self: the same walk, found by its id.
    const auto self = std::ranges::find(data.walks, attacked.walks[w].walk.id, [](const ScoredWalk& walk) { return walk.walk.id; });
    const auto s = static_cast<std::size_t>(self - data.walks.begin());
    std::ranges::copy(errors_from(data.instants[s], clean.walks[s], *attacked.began[w]), std::back_inserter(clean_errors));
    if (const auto error = error_by(data.instants[s], clean.walks[s], *attacked.began[w], kBackWithin)) clean_at15.push_back(*error);
  }
  row.instants = errors.size();
  row.flagged = row.walks == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(flagged) / static_cast<double>(row.walks);
  row.p75_m = p(errors, 0.75), row.p95_m = p(errors, 0.95);
  row.clean_p75_m = p(clean_errors, 0.75), row.clean_p95_m = p(clean_errors, 0.95);
  for (const Scope scope : {Scope::kAll, Scope::kCovered}) {
    const auto s = static_cast<std::size_t>(scope);
    row.carried[s] = found_back(at15, scope), row.switched_on[s] = found_back(clean_at15, scope);
  }
  return row;
}

AlarmRow count_alarms(const ScoredData& data, const PipelineRun& run) {
  AlarmRow row{run.pipeline};
  std::size_t answers = 0, suspect = 0, degraded = 0;
  for (std::size_t w = 0; w < data.walks.size(); ++w) {
    row.hours += data.walks[w].walk.duration_s() / 3600.0;
    bool before = false;
    for (const auto& answer : run.walks[w]) {
      if (!answer) continue;
      ++answers;
      const bool now = answer->integrity == Integrity::kSuspect;
      suspect += now;
      degraded += answer->integrity == Integrity::kDegraded;
      row.alarms += now && !before;
      before = now;
    }
  }
  if (answers > 0) {
    row.suspect = static_cast<double>(suspect) / static_cast<double>(answers);
    row.degraded = static_cast<double>(degraded) / static_cast<double>(answers);
  }
  return row;
}

SurveyPoison::SurveyPoison(std::span<const RecordedWalk> survey, double points, double walks, std::uint64_t seed)
    : points_(points), walks_(walks), seed_(seed) {
  for (const RecordedWalk& walk : survey) {
    for (const TruePoint& point : walk.way_points) places_.push_back({point.point, walk.floor});
  }
}

std::size_t SurveyPoison::among(std::span<const DoubtfulPoint> doubts) const {
  return static_cast<std::size_t>(std::ranges::count_if(doubts, [&](const DoubtfulPoint& doubt) {
    return std::ranges::any_of(moved_, [&](const ReferencePoint& point) {
      return point.walk == doubt.walk && point.surveyed_at == doubt.surveyed_at && point.place.floor == doubt.stated.floor &&
             distance_m(point.place.point, doubt.stated.point) < kSamePlace_m;
    });
  }));
}

void SurveyPoison::operator()(std::vector<SurveyBatch>& batches) {
  const auto note = [&](const ReferencePoint& point) {
    moved_.push_back({point.place, point.sigma_m, point.device_model, point.walk, point.surveyed_at, {}});
  };
  for (SurveyBatch& batch : batches) {
    for (ReferencePoint& point : batch.points) {
      Random of_walk(fnv1a(point.walk) ^ seed_);
      if (of_walk.uniform() < walks_) {
        const double direction_rad = 2.0 * std::numbers::pi * of_walk.uniform();
        point.place.point.x_m += 30.0 * std::cos(direction_rad);
        point.place.point.y_m += 30.0 * std::sin(direction_rad);
        note(point);
        continue;
      }
      Random of_point(of_walk.bits() ^ static_cast<std::uint64_t>(point.scans.empty() ? 0 : point.scans.front().time.time_since_epoch().count()));
      if (of_point.uniform() >= points_) continue;
      for (int tries = 0; tries < 100; ++tries) {
        const Place other = places_[of_point.below(places_.size())];
        if (other.floor == point.place.floor && distance_m(other.point, point.place.point) < 20.0) continue;
        point.place = other;
        break;
      }
      note(point);
    }
  }
}

}  // namespace wayfuse
