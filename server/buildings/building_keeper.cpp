#include "server/buildings/building_keeper.hpp"

#include <algorithm>
#include <exception>
#include <iterator>
#include <utility>

#include "server/buildings/walk_placing.hpp"
#include "server/pipeline/corrector.hpp"

namespace wayfuse {

BuildingKeeper::BuildingKeeper(DatabaseDirectory& store, BuildingShelf& shelf, Run run, Settings settings)
    : store_(store), shelf_(shelf), run_(std::move(run)), settings_(std::move(settings)) {}

void BuildingKeeper::refresh(BuildingId id) {
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return;
    if (settings_.now && settings_.least_between > Duration{0}) {
      const ServerTime now = settings_.now();
      const auto made = made_.find(id);
      if (made != made_.end() && now < made->second + settings_.least_between) {
        due_.try_emplace(id, made->second + settings_.least_between);
        return;
      }
    }
    due_.erase(id);
    const auto [work, fresh] = working_.try_emplace(id);
    if (!fresh) {
      work->second.again = true;
      return;
    }
  }
  begin(id);
}

void BuildingKeeper::refresh(BuildingId id, std::function<void()> ended) {
  bool going = true;
  {
    const std::lock_guard lock(mutex_);
    going = !stopped_;
    if (going) {
      due_.erase(id);
      const auto [work, fresh] = working_.try_emplace(id);
      work->second.again = !fresh;
      (fresh ? work->second.waiting : work->second.next).push_back(std::move(ended));
      if (!fresh) return;
    }
  }
  going ? begin(id) : ended();
}

void BuildingKeeper::tick() {
  for (const auto& building : shelf_.all()) keep(*building);  // a session may have asked for a pipeline that learnt something
  std::vector<BuildingId> ripe;
  {
    const std::lock_guard lock(mutex_);
    if (due_.empty() || !settings_.now) return;
    const ServerTime now = settings_.now();
    for (const auto& [id, time] : due_) {
      if (time <= now) ripe.push_back(id);
    }
  }
  for (const BuildingId id : ripe) refresh(id);
}

void BuildingKeeper::begin(BuildingId id) {
  store_.with_building(id, [this, id](Result<BuildingDatabase*> database) { read(id, std::move(database)); });
}

void BuildingKeeper::read(BuildingId id, Result<BuildingDatabase*> database) {
  if (!database && database.fault().code == FaultCode::kUnknownBuilding) {  // removed
    shelf_.remove(id);
    forget(id);
    return done(id, std::nullopt);
  }
  if (!database) return done(id, database.fault());
  if (const auto placed = place_recorded_walks(**database); !placed) return done(id, placed.fault());
  auto round = read_round(**database);
  if (!round) return done(id, round.fault());
  run_([this, id, round = std::make_shared<Round>(*std::move(round))] { build(id, std::move(*round)); });
}

Result<BuildingKeeper::Round> BuildingKeeper::read_round(BuildingDatabase& database) {
  auto record = database.building();
  if (!record) return record.fault();
  Round round{*std::move(record), {}, {}, {}, {}};
  MapVersions versions(database);
  // A full disk keeps a new version from being written; what is live serves on.
  const auto renewed = renew(database, round.record, round);
  if (!renewed && renewed.fault().code != FaultCode::kStorageFull && renewed.fault().code != FaultCode::kStorageFailed) return renewed.fault();
  const auto live = versions.live();
  if (!live) return live.fault();
  if (!*live && !renewed) {
    auto survey = versions.survey_as_it_stands();
    if (!survey) return survey.fault();
    round.live = *std::move(survey);
  }
  if (!*live) return round;
  auto material = versions.material(**live);
  if (!material) return material.fault();
  round.live = *std::move(material);
  round.expected_live = round.live.version;
  for (const std::string& pipeline : preset_names()) {
    const auto corrector = database.corrector(pipeline);
    if (!corrector) return corrector.fault();
    const bool current = *corrector && (*corrector)->survey_version == round.live.version && Corrector::parse((*corrector)->content);
    if (current) round.live.correctors.emplace(pipeline, (*corrector)->content);
  }
  return round;
}

// Stages the survey as it stands, and promotes it or leaves it to the judge.
Result<void> BuildingKeeper::renew(BuildingDatabase& database, const BuildingRecord& record, Round& round) {
  MapVersions versions(database);
  const auto automatic = versions.automatic(record);
  if (!automatic) return automatic.fault();
  if (!*automatic) return {};
  const auto staged = versions.stage(wall_now());
  if (!staged) {
    if (staged.fault().code == FaultCode::kEmptyRadioMap) return {};
    return staged.fault();
  }
  const auto settled = versions.is_settled(*staged);
  if (!settled) return settled.fault();
  if (*settled) return {};
  const auto live = database.live_map();
  if (!live) return live.fault();
  auto walks = database.quality_walks();
  if (!walks) return walks.fault();
  if (!settings_.judge || walks->empty() || !*live) {
    Publication publication;
    publication.version = staged->version;
    publication.at = wall_now();
    publication.reason = "by itself: survey version " + std::to_string(staged->survey_version);
    const auto promoted = database.promote(publication, *live);
    if (!promoted) return promoted.fault();
    made_a_version(record.id);
    return {};
  }
  auto candidate = versions.material(*staged);
  if (!candidate) return candidate.fault();
  for (const QualityWalkRecord& walk : *walks) {
    auto content = database.quality_walk_content(walk.id);
    if (!content) return content.fault();
    round.walks.push_back({walk, *std::move(content)});
  }
  round.candidate = *std::move(candidate);
  return {};
}

void BuildingKeeper::build(BuildingId id, Round round) {
  try {
    auto live = Building::make(round.record, std::move(round.live), settings_.gate);
    if (!live) return done(id, live.fault());
    if (!round.candidate) {
      keep(**live);
      prepare(**live);
      shelf_.put(*std::move(live));
      return done(id, std::nullopt);
    }
    auto candidate = Building::make(round.record, std::move(*round.candidate), settings_.gate);
    if (!candidate) return done(id, candidate.fault());
    MapJudgement judgement = settings_.judge(**candidate, live->get(), round.walks);
    prepare(judgement.publish ? **candidate : **live);
    conclude(id, *std::move(candidate), *std::move(live), std::move(round), std::move(judgement));
  } catch (const std::exception& broken) {  // out of memory over one huge survey must not end the server
    done(id, Fault{FaultCode::kInternal, "building", broken.what()});
  }
}

void BuildingKeeper::prepare(const Building& building) const {
  if (const auto older = shelf_.find(building.record().id)) building.prepare_as(*older);
}

// Trained once a map version: the next start finds it. A disk that does not take it only costs the training again.
void BuildingKeeper::keep(const Building& building) {
  for (const auto& [pipeline, content] : building.newly_learnt()) {
    CorrectorRecord corrector{pipeline, building.map_version(), content};
    store_.with_building(building.record().id, [corrector = std::move(corrector)](Result<BuildingDatabase*> database) {
      if (database) static_cast<void>((*database)->keep_corrector(corrector));
    });
  }
}

// Writes down what the judge found; only then, and only if nobody else published meanwhile, the candidate comes into force.
void BuildingKeeper::conclude(BuildingId id, std::shared_ptr<const Building> candidate, std::shared_ptr<const Building> live, Round round,
                              MapJudgement judgement) {
  store_.with_building(id, [this, id, candidate = std::move(candidate), live = std::move(live), expected = round.expected_live,
                            judgement = std::move(judgement)](Result<BuildingDatabase*> database) {
    if (!database) return done(id, database.fault());
    for (const MapQuality& quality : judgement.qualities) {
      // A walk removed meanwhile takes its figures with it.
      if (const auto noted = (*database)->note_quality(quality); !noted && noted.fault().code != FaultCode::kNotFound) return done(id, noted.fault());
    }
    bool promoted = false;
    if (judgement.publish) {
      Publication publication;
      publication.version = candidate->site()->radio_map_version;
      publication.at = wall_now();
      publication.reason = "by itself: " + judgement.reason;
      const auto published = (*database)->promote(publication, expected);
      if (!published && published.fault().code != FaultCode::kConflict) return done(id, published.fault());
      promoted = published.has_value();
    }
    if (promoted) {
      made_a_version(id);
      keep(*candidate);
    }
    shelf_.put(promoted ? candidate : live);
    done(id, std::nullopt);
  });
}

void BuildingKeeper::forget(BuildingId id) {
  const std::lock_guard lock(mutex_);
  made_.erase(id);
  due_.erase(id);
}

void BuildingKeeper::made_a_version(BuildingId id) {
  if (!settings_.now) return;
  const std::lock_guard lock(mutex_);
  made_.insert_or_assign(id, settings_.now());
}

void BuildingKeeper::done(BuildingId id, std::optional<Fault> fault) {
  std::vector<std::function<void()>> waited;
  const bool again = conclude_round(id, std::move(fault), waited);
  for (const auto& ended : waited) ended();
  if (again) begin(id);
}

// Answers whether another round is to begin; who waited for this one is handed over, to be told without the mutex.
bool BuildingKeeper::conclude_round(BuildingId id, std::optional<Fault> fault, std::vector<std::function<void()>>& waited) {
  const std::lock_guard lock(mutex_);
  ++rebuilds_;
  once_done_.insert(id);
  settled_.notify_all();
  if (fault) {
    failures_[id] = *std::move(fault);
  } else {
    failures_.erase(id);
  }
  Work& work = working_.at(id);
  waited = std::exchange(work.waiting, std::exchange(work.next, {}));
  const bool again = work.again && !stopped_;
  work.again = false;
  if (!again) {
    std::ranges::move(work.waiting, std::back_inserter(waited));  // there is no round after this one
    working_.erase(id);
  }
  return again;
}

void BuildingKeeper::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
}

std::vector<std::pair<BuildingId, Fault>> BuildingKeeper::failures() const {
  const std::lock_guard lock(mutex_);
  return {failures_.begin(), failures_.end()};
}

bool BuildingKeeper::settled() const {
  const std::lock_guard lock(mutex_);
  return working_.empty();
}

void BuildingKeeper::settle() const {
  std::unique_lock lock(mutex_);
  settled_.wait(lock, [this] { return working_.empty(); });
}

void BuildingKeeper::wait_for_first_round(const std::vector<BuildingId>& ids) const {
  std::unique_lock lock(mutex_);
  settled_.wait(lock, [&] { return std::ranges::all_of(ids, [this](BuildingId id) { return once_done_.contains(id); }); });
}

std::uint64_t BuildingKeeper::rebuilds() const {
  const std::lock_guard lock(mutex_);
  return rebuilds_;
}

}  // namespace wayfuse
