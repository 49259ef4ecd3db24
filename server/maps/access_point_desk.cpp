#include "server/maps/access_point_desk.hpp"

#include <algorithm>

namespace wayfuse {
namespace {

constexpr double kResurvey_dbm = -75.0;
constexpr double kResurveyApart_m = 10.0;
constexpr std::size_t kResurveyMost = 12;

std::vector<Bssid> distrusted(const std::vector<AccessPointRecord>& records) {
  std::vector<Bssid> found;
  for (const AccessPointRecord& record : records) {
    if (record.distrusted()) found.push_back(record.bssid);
  }
  return found;
}

AccessPointCounts count(const std::vector<AccessPointRecord>& records) {
  AccessPointCounts counts;
  for (const AccessPointRecord& record : records) {
    switch (record.state) {
      case AccessPointState::kOk: ++counts.ok; break;
      case AccessPointState::kVanished: ++counts.vanished; break;
      case AccessPointState::kMoved: ++counts.moved; break;
      case AccessPointState::kPowerChanged: ++counts.power_changed; break;
      case AccessPointState::kNew: ++counts.fresh; break;
    }
    counts.distrusted += record.distrusted();
  }
  return counts;
}

// The records as they will stand: the verdicts over what was there.
std::vector<AccessPointRecord> merged(std::vector<AccessPointRecord> before, const std::vector<AccessPointRecord>& verdicts) {
  for (const AccessPointRecord& verdict : verdicts) {
    const auto found = std::ranges::lower_bound(before, verdict.bssid, {}, &AccessPointRecord::bssid);
    if (found != before.end() && found->bssid == verdict.bssid) {
      *found = verdict;
    } else {
      before.insert(found, verdict);
    }
  }
  return before;
}

}  // namespace

AccessPointDesk::AccessPointDesk(DatabaseDirectory& store, const BuildingShelf& shelf, std::function<UnixTime()> wall_now,
                                 std::function<void(BuildingId)> distrust_changed)
    : store_(store), shelf_(shelf), wall_now_(std::move(wall_now)), distrust_changed_(std::move(distrust_changed)) {}

void AccessPointDesk::hear(std::uint64_t session, const Building& building, const RssScan& scan, const FusedPosition& position) {
  if (building.map_version() == 0) return;
  std::shared_ptr<AccessPointWatch> watch;
  {
    const std::lock_guard lock(mutex_);
    Watched& watched = watched_[building.record().id];
    // A session may still walk on an older map: only the newest survey is watched.
    if (watched.watch && building.map_survey_version() < watched.survey_version) return;
    if (!watched.watch || building.map_survey_version() > watched.survey_version) {
      watched = {building.map_survey_version(), std::make_shared<AccessPointWatch>(building.levels()), 0, watched.counts};
    }
    watch = watched.watch;
  }
  watch->hear(session, scan, position, wall_now_());
}

void AccessPointDesk::review() {
  std::vector<std::pair<BuildingId, std::shared_ptr<AccessPointWatch>>> changed;
  {
    const std::lock_guard lock(mutex_);
    for (auto& [id, watched] : watched_) {
      const std::size_t scans = watched.watch->scans();
      if (scans == watched.reviewed_scans) continue;
      watched.reviewed_scans = scans;
      changed.emplace_back(id, watched.watch);
    }
  }
  for (const auto& [id, watch] : changed) {
    store_.with_building(id, [this, building = id, watched = watch](Result<BuildingDatabase*> database) {
      if (database) review_one(building, watched, **database);
    });
  }
}

void AccessPointDesk::review_one(BuildingId id, const std::shared_ptr<AccessPointWatch>& watch, BuildingDatabase& database) {
  const auto before = database.access_points();
  if (!before) return;
  auto verdicts = watch->verdicts(*before, wall_now_());
  auto after = merged(*before, verdicts);
  const auto building = shelf_.find(id);
  const double known = building ? static_cast<double>(building->levels()->transmitters().size()) : 0.0;
  const std::size_t most = std::max<std::size_t>(1, static_cast<std::size_t>(kMostDistrusted * known));
  if (distrusted(after).size() > most && distrusted(after).size() > distrusted(*before).size()) {
    // Shown, but not acted on: the verdicts wait for an operator.
    std::erase_if(verdicts, [&](const AccessPointRecord& verdict) {
      const auto old = std::ranges::find(*before, verdict.bssid, &AccessPointRecord::bssid);
      return verdict.distrusted() && (old == before->end() || !old->distrusted());
    });
    after = merged(*before, verdicts);
  }
  if (!database.note_verdicts(verdicts)) return;  // a full disk: the next review writes them
  {
    const std::lock_guard lock(mutex_);
    watched_[id].counts = count(after);
  }
  if (distrusted(after) != distrusted(*before)) distrust_changed_(id);
}

AccessPointView AccessPointDesk::view_of(BuildingId id, AccessPointRecord record) const {
  AccessPointView view{std::move(record), false, {}};
  const auto building = shelf_.find(id);
  if (!building) return view;
  const auto levels = building->levels();
  view.on_map = levels->knows(view.record.bssid);
  const AccessPointState state = view.record.state;
  if (view.on_map && state != AccessPointState::kOk && state != AccessPointState::kNew) {
    view.resurvey = levels->where_heard(view.record.bssid, kResurvey_dbm, kResurveyApart_m, kResurveyMost);
  }
  return view;
}

void AccessPointDesk::list(BuildingId id, MapControl::Done<std::vector<AccessPointView>> done) {
  const auto watch = watch_of(id);
  store_.with_building(id, [this, id, watch, done = std::move(done)](Result<BuildingDatabase*> database) {
    if (!database) return done(database.fault());
    if (watch) review_one(id, watch, **database);
    auto records = (*database)->access_points();
    if (!records) return done(records.fault());
    std::vector<AccessPointView> views;
    for (AccessPointRecord& record : *records) views.push_back(view_of(id, std::move(record)));
    done(std::move(views));
  });
}

void AccessPointDesk::trust(BuildingId id, Bssid bssid, AccessPointTrust trust, MapControl::Done<AccessPointView> done) {
  store_.with_building(id, [this, id, bssid, trust, done = std::move(done)](Result<BuildingDatabase*> database) {
    if (!database) return done(database.fault());
    if (const auto set = (*database)->set_trust(bssid, trust, wall_now_()); !set) return done(set.fault());
    const auto records = (*database)->access_points();
    if (!records) return done(records.fault());
    const auto record = std::ranges::find(*records, bssid, &AccessPointRecord::bssid);
    done(view_of(id, *record));
  });
}

std::shared_ptr<AccessPointWatch> AccessPointDesk::watch_of(BuildingId building) const {
  const std::lock_guard lock(mutex_);
  const auto found = watched_.find(building);
  return found == watched_.end() ? nullptr : found->second.watch;
}

AccessPointCounts AccessPointDesk::counts() const {
  const std::lock_guard lock(mutex_);
  AccessPointCounts sum;
  for (const auto& [_, watched] : watched_) {
    sum.ok += watched.counts.ok, sum.vanished += watched.counts.vanished, sum.moved += watched.counts.moved;
    sum.power_changed += watched.counts.power_changed, sum.fresh += watched.counts.fresh, sum.distrusted += watched.counts.distrusted;
  }
  return sum;
}

}  // namespace wayfuse
