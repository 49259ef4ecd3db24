#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "db/building_database.hpp"
#include "server/buildings/doubtful_point.hpp"
#include "server/buildings/map_versions.hpp"
#include "server/buildings/survey_levels.hpp"
#include "server/pipeline/tracker.hpp"

namespace wayfuse {

class DatabaseDirectory;

/// An immutable snapshot of a building, ready to track in: what sessions hold while a newer one is made.
class Building {
 public:
  /// Builds the radio map and the building's own pipeline; other presets are made when first asked for.
  /// Readings of distrusted transmitters are left out of the map, and its trackers do not hear them. Points that the rest of the
  /// survey contradicts stay out of every pipeline's map (and stay in the store): doubts().
  static Result<std::shared_ptr<const Building>> make(BuildingRecord record, MapMaterial map, bool gate = true);
  /// From a survey alone, under its own version's number.
  static Result<std::shared_ptr<const Building>> make(BuildingRecord record, std::vector<ReferencePoint> survey, bool gate = true);

  const BuildingRecord& record() const { return *record_; }
  const std::shared_ptr<const BuildingRecord>& shared_record() const { return record_; }
  const std::shared_ptr<const Site>& site() const { return site_; }
  /// Of the map every fix of this snapshot names; 0 = the building has none.
  std::uint64_t map_version() const { return site_->radio_map_version; }
  std::uint64_t map_survey_version() const { return map_survey_version_; }
  /// Transmitters the map leaves out, ascending; and whether points were erased since the version was built.
  std::span<const Bssid> distrusted() const { return distrusted_; }
  bool map_is_whole() const { return map_is_whole_; }
  /// How the map did on the quality walks when this snapshot was made.
  const std::vector<MapQuality>& qualities() const { return qualities_; }
  /// What the survey says phones should hear, distrusted transmitters too. Made when first asked for.
  std::shared_ptr<const SurveyLevels> levels() const;
  /// Empty name = the building's own pipeline. Thread: any.
  Result<std::shared_ptr<const TrackerFactory>> pipeline(const std::string& name) const;
  /// The same where it is at hand; absent: it is not made yet, which may take a while.
  std::optional<Result<std::shared_ptr<const TrackerFactory>>> pipeline_at_hand(const std::string& name) const;
  /// True the first time it is called for that pipeline: who hears it makes it, by pipeline().
  bool is_first_to_prepare(const std::string& name) const;
  /// Names of the pipelines made so far, ascending.
  std::vector<std::string> prepared() const;
  /// Makes ready what sessions track with over `older`, so that none of them waits for it when it moves here.
  void prepare_as(const Building& older) const;
  /// Of the building's own pipeline: what it could not prepare.
  std::vector<std::string> remarks() const;
  /// What pipelines made so far learnt from the survey and the map's material did not hold, by pipeline, to be kept: each is told once.
  std::map<std::string, std::string> newly_learnt() const;
  /// Points left out of the map, ascending by their index in the survey as stored, and why.
  std::span<const DoubtfulPoint> doubts() const { return doubts_; }
  /// Transmitters this survey knows, ascending; for resolving a session without a building id.
  std::span<const Bssid> transmitters() const { return transmitters_; }

 private:
  Building() = default;
  std::shared_ptr<const BuildingRecord> record_;
  std::shared_ptr<const Site> site_;
  std::vector<DoubtfulPoint> doubts_;
  std::vector<Bssid> transmitters_;
  std::vector<Bssid> distrusted_;
  std::uint64_t map_survey_version_ = 0;
  bool map_is_whole_ = true;
  std::vector<MapQuality> qualities_;
  std::vector<ReferencePoint> surveyed_;  // as it was, where the map leaves something out; otherwise the site has it
  mutable std::shared_ptr<const SurveyLevels> levels_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::shared_ptr<const TrackerFactory>> pipelines_;
  mutable std::map<std::string, Fault> refused_;  // pipelines that cannot be made of this snapshot
  mutable std::set<std::string> being_prepared_;
  mutable std::set<std::string> told_;            // newly_learnt() has spoken of these pipelines
};

/// id -> newest snapshot. Shared between threads: one mutex, never held while calling out.
class BuildingShelf {
 public:
  std::shared_ptr<const Building> find(BuildingId id) const;
  void put(std::shared_ptr<const Building> building);
  void remove(BuildingId id);
  std::vector<std::shared_ptr<const Building>> all() const;
  /// The building that knows most of these access points: at least `least` of them and twice as many as the runner-up.
  std::optional<BuildingId> resolve(std::span<const Bssid> heard, std::size_t least = 3) const;

 private:
  mutable std::mutex mutex_;
  std::map<BuildingId, std::shared_ptr<const Building>> shelf_;
};

/// The snapshot of a building somebody asks for. What the store has and no map stands for yet, as right after a start, is
/// kOverloaded: who asks comes again; kUnknownBuilding would send a phone away for good.
Result<std::shared_ptr<const Building>> ready_building(const BuildingShelf& shelf, const DatabaseDirectory& store, BuildingId id);

}  // namespace wayfuse
