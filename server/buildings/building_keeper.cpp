#include "server/buildings/building_keeper.hpp"

#include <algorithm>
#include <exception>

#include "server/pipeline/corrector.hpp"

namespace wayfuse {

BuildingKeeper::BuildingKeeper(DatabaseDirectory& store, BuildingShelf& shelf, Run run, bool gate)
    : store_(store), shelf_(shelf), run_(std::move(run)), gate_(gate) {}

void BuildingKeeper::refresh(BuildingId id) {
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return;
    const auto [work, fresh] = working_.try_emplace(id);
    if (!fresh) {
      work->second.again = true;
      return;
    }
  }
  begin(id);
}

void BuildingKeeper::begin(BuildingId id) {
  store_.with_building(id, [this, id](Result<BuildingDatabase*> database) { read(id, std::move(database)); });
}

void BuildingKeeper::read(BuildingId id, Result<BuildingDatabase*> database) {
  if (!database && database.fault().code == FaultCode::kUnknownBuilding) {  // removed
    shelf_.remove(id);
    return done(id, std::nullopt);
  }
  if (!database) return done(id, database.fault());
  auto survey = read_survey(**database);
  if (!survey) return done(id, survey.fault());
  run_([this, id, survey = std::make_shared<Survey>(*std::move(survey))] { build(id, std::move(*survey)); });
}

Result<BuildingKeeper::Survey> BuildingKeeper::read_survey(BuildingDatabase& database) {
  auto record = database.building();
  if (!record) return record.fault();
  const auto corrector = database.corrector(record->pipeline);
  if (!corrector) return corrector.fault();
  const bool current = *corrector && (*corrector)->survey_version == record->survey_version && Corrector::parse((*corrector)->content);
  Survey survey{*std::move(record), {}, current ? (*corrector)->content : std::string{}};
  for (PointQuery query;;) {
    auto page = database.points(query);
    if (!page) return page.fault();
    if (page->empty()) return survey;
    query.after_id = page->back().id;
    for (StoredPoint& stored : *page) survey.points.push_back(std::move(stored.point));
  }
}

void BuildingKeeper::build(BuildingId id, Survey survey) {
  try {
    auto building = Building::make(std::move(survey.record), std::move(survey.points), gate_, survey.corrector);
    if (!building) return done(id, building.fault());
    keep(**building, survey.corrector);
    shelf_.put(*std::move(building));
    done(id, std::nullopt);
  } catch (const std::exception& broken) {  // out of memory over one huge survey must not end the server
    done(id, Fault{FaultCode::kInternal, "building", broken.what()});
  }
}

// Trained once a survey version: the next start finds it. A disk that does not take it only costs the training again.
void BuildingKeeper::keep(const Building& building, const std::string& stored) {
  CorrectorRecord corrector{building.record().pipeline, building.record().survey_version, building.learnt()};
  if (corrector.content.empty() || corrector.content == stored) return;
  store_.with_building(building.record().id, [corrector = std::move(corrector)](Result<BuildingDatabase*> database) {
    if (database) static_cast<void>((*database)->keep_corrector(corrector));
  });
}

void BuildingKeeper::done(BuildingId id, std::optional<Fault> fault) {
  {
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
    if (!work.again || stopped_) {
      working_.erase(id);
      return;
    }
    work.again = false;
  }
  begin(id);
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
