#include "server/buildings/building_shelf.hpp"

#include <algorithm>
#include <set>

#include "db/database_directory.hpp"
#include "server/buildings/deaf_tracker.hpp"
#include "server/buildings/device_offsets.hpp"
#include "wayfuse/proto/magnetic_model.hpp"

namespace wayfuse {
namespace {

std::vector<Bssid> transmitters_of(const std::vector<ReferencePoint>& survey) {
  std::set<Bssid> heard;
  for (const ReferencePoint& point : survey) {
    for (const RssScan& scan : point.scans) {
      for (const ScanReading& reading : scan.readings) heard.insert(reading.bssid);
    }
  }
  return {heard.begin(), heard.end()};
}

// Takes what the gate doubts out of the survey.
std::vector<DoubtfulPoint> take_doubtful(std::vector<ReferencePoint>& survey) {
  std::vector<DoubtfulPoint> taken;
  for (const SurveyDoubt& doubt : doubtful_points(survey)) {
    const ReferencePoint& point = survey[doubt.point];
    taken.push_back({doubt, point.place, point.walk, point.device_model, point.surveyed_at});
  }
  std::size_t next = 0, index = 0;
  std::erase_if(survey, [&](const ReferencePoint&) {
    const bool doubted = next < taken.size() && taken[next].doubt.point == index;
    next += doubted;
    ++index;
    return doubted;
  });
  return taken;
}

// The survey as if those transmitters had never been heard; a point that heard nothing else says nothing.
std::vector<ReferencePoint> without(std::vector<ReferencePoint> survey, const std::vector<Bssid>& distrusted) {
  if (distrusted.empty()) return survey;
  for (ReferencePoint& point : survey) {
    for (RssScan& scan : point.scans) {
      std::erase_if(scan.readings, [&](const ScanReading& reading) { return std::ranges::binary_search(distrusted, reading.bssid); });
    }
    std::erase_if(point.scans, [](const RssScan& scan) { return scan.readings.empty(); });
  }
  std::erase_if(survey, [](const ReferencePoint& point) { return point.scans.empty(); });
  return survey;
}

std::size_t count_known(std::span<const Bssid> known, std::span<const Bssid> heard) {
  return static_cast<std::size_t>(
      std::ranges::count_if(heard, [&](Bssid bssid) { return std::ranges::binary_search(known, bssid); }));
}

// The year the survey ends in, for a field that drifts.
double year_of(const std::vector<ReferencePoint>& survey) {
  constexpr double kYear_s = 365.2425 * 86400.0;
  UnixTime newest{};
  for (const ReferencePoint& point : survey) newest = std::max(newest, point.surveyed_at);
  return 1970.0 + seconds(newest.time_since_epoch()) / kYear_s;
}

}  // namespace

Result<std::shared_ptr<const Building>> Building::make(BuildingRecord record, std::vector<ReferencePoint> survey, bool gate) {
  MapMaterial map;
  map.version = map.survey_version = record.survey_version;
  map.points = std::move(survey);
  return make(std::move(record), std::move(map), gate);
}

Result<std::shared_ptr<const Building>> Building::make(BuildingRecord record, MapMaterial map, bool gate) {
  std::shared_ptr<Building> building(new Building());
  apply_device_offsets(map.device_offsets_db, map.points);
  if (gate) building->doubts_ = take_doubtful(map.points);
  if (!map.distrusted.empty()) building->surveyed_ = map.points;
  std::vector<ReferencePoint> survey = without(std::move(map.points), map.distrusted);
  building->distrusted_ = std::move(map.distrusted);
  building->map_is_whole_ = map.whole;
  building->qualities_ = std::move(map.qualities);
  building->map_survey_version_ = map.survey_version;
  building->transmitters_ = transmitters_of(survey);
  // An operator who tells where the building lies need not look its declination up.
  if (record.georeference && record.magnetic_field == MagneticField{} && !survey.empty()) {
    record.magnetic_field = main_field(record.georeference->origin, year_of(survey));
  }
  auto site = std::make_shared<Site>();
  site->building = record.id;
  site->georeference = record.georeference;
  site->magnetic_field = record.magnetic_field;
  site->floors = record.floors;
  site->survey = std::move(survey);
  site->radio_map_version = map.version;
  site->correctors = std::move(map.correctors);
  building->site_ = std::move(site);
  building->record_ = std::make_shared<const BuildingRecord>(std::move(record));
  const auto own = building->pipeline("");
  if (!own) return own.fault();
  return std::shared_ptr<const Building>(std::move(building));
}

std::vector<std::string> Building::remarks() const { return pipeline("").value()->remarks(); }

std::map<std::string, std::string> Building::newly_learnt() const {
  std::map<std::string, std::string> learnt;
  const std::lock_guard lock(mutex_);
  for (const auto& [name, factory] : pipelines_) {
    if (!told_.insert(name).second) continue;
    std::string content = factory->learnt();
    const auto handed_in = site_->correctors.find(name);
    const bool known = handed_in != site_->correctors.end() && handed_in->second == content;
    if (!content.empty() && !known) learnt.emplace(name, std::move(content));
  }
  return learnt;
}

std::shared_ptr<const SurveyLevels> Building::levels() const {
  {
    const std::lock_guard lock(mutex_);
    if (levels_) return levels_;
  }
  const auto made = std::make_shared<const SurveyLevels>(distrusted_.empty() ? site_->survey : surveyed_);
  const std::lock_guard lock(mutex_);
  if (!levels_) levels_ = made;
  return levels_;
}

Result<std::shared_ptr<const TrackerFactory>> Building::pipeline(const std::string& name) const {
  const std::string& wanted = name.empty() ? record_->pipeline : name;
  {
    const std::lock_guard lock(mutex_);
    const auto found = pipelines_.find(wanted);
    if (found != pipelines_.end()) return found->second;
  }
  const auto spec = preset(wanted);
  if (!spec) return spec.fault();
  const auto factory = assemble(*spec, site_);
  const std::lock_guard lock(mutex_);
  if (!factory) {
    refused_.insert_or_assign(wanted, factory.fault());
    return factory.fault();
  }
  return pipelines_.try_emplace(wanted, deaf_to(distrusted_, *factory)).first->second;
}

std::optional<Result<std::shared_ptr<const TrackerFactory>>> Building::pipeline_at_hand(const std::string& name) const {
  using Answer = Result<std::shared_ptr<const TrackerFactory>>;
  const std::string& wanted = name.empty() ? record_->pipeline : name;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = pipelines_.find(wanted); found != pipelines_.end()) return Answer(found->second);
    if (const auto found = refused_.find(wanted); found != refused_.end()) return Answer(found->second);
  }
  if (const auto spec = preset(wanted); !spec) return Answer(spec.fault());
  return std::nullopt;
}

bool Building::is_first_to_prepare(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  return being_prepared_.insert(name.empty() ? record_->pipeline : name).second;
}

std::vector<std::string> Building::prepared() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, _] : pipelines_) names.push_back(name);
  return names;
}

void Building::prepare_as(const Building& older) const {
  std::vector<std::string> used;
  {
    const std::lock_guard lock(older.mutex_);
    for (const auto& [name, factory] : older.pipelines_) {
      if (factory.use_count() > 1) used.push_back(name);
    }
  }
  for (const std::string& name : used) static_cast<void>(pipeline(name));  // a fault comes again when somebody asks
}

std::shared_ptr<const Building> BuildingShelf::find(BuildingId id) const {
  const std::lock_guard lock(mutex_);
  const auto found = shelf_.find(id);
  return found != shelf_.end() ? found->second : nullptr;
}

void BuildingShelf::put(std::shared_ptr<const Building> building) {
  const BuildingId id = building->record().id;
  const std::lock_guard lock(mutex_);
  shelf_[id].swap(building);  // the old snapshot, if nobody holds it, is destroyed outside the lock
}

void BuildingShelf::remove(BuildingId id) {
  std::shared_ptr<const Building> old;
  const std::lock_guard lock(mutex_);
  const auto found = shelf_.find(id);
  if (found == shelf_.end()) return;
  old.swap(found->second);
  shelf_.erase(found);
}

std::vector<std::shared_ptr<const Building>> BuildingShelf::all() const {
  std::vector<std::shared_ptr<const Building>> snapshots;
  const std::lock_guard lock(mutex_);
  for (const auto& [_, building] : shelf_) snapshots.push_back(building);
  return snapshots;
}

std::optional<BuildingId> BuildingShelf::resolve(std::span<const Bssid> heard, std::size_t least) const {
  std::optional<BuildingId> best;
  std::size_t most = 0;
  std::size_t second = 0;
  for (const auto& building : all()) {
    const std::size_t known = count_known(building->transmitters(), heard);
    if (known > most) {
      second = most;
      most = known;
      best = building->record().id;
    } else {
      second = std::max(second, known);
    }
  }
  return most >= least && most >= 2 * second ? best : std::nullopt;
}

Result<std::shared_ptr<const Building>> ready_building(const BuildingShelf& shelf, const DatabaseDirectory& store, BuildingId id) {
  if (auto building = shelf.find(id)) return building;
  if (std::ranges::count(store.buildings(), id) > 0) {
    return Fault{FaultCode::kOverloaded, "building", "its radio map is being made ready; come again"};
  }
  return Fault{FaultCode::kUnknownBuilding, "building", "there is no such building for this key"};
}

}  // namespace wayfuse
