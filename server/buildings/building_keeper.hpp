#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "db/database_directory.hpp"
#include "server/buildings/building_shelf.hpp"
#include "server/buildings/map_versions.hpp"

namespace wayfuse {

/// What the gate says of a candidate, and the figures to keep.
struct MapJudgement {
  bool publish = true;
  std::string reason;
  std::vector<MapQuality> qualities;
};

/// Keeps the shelf true to the store: places recorded walks, builds a version from a changed survey where the building's maps
/// come into force by themselves, and swaps the snapshot of the live version in. Changes that come while one is being built are
/// taken together in the next round.
///
/// Thread: any; one mutex, never held while calling out. Must outlive the store's and the workers' tasks: see settle().
class BuildingKeeper {
 public:
  /// Runs a task some time later, off the caller's thread (or inline, in a simulation).
  using Run = std::function<void(std::function<void()>)>;
  /// Holds a candidate against what is in force (null: nothing is) on the building's quality walks. On a worker.
  using Judge = std::function<MapJudgement(const Building& candidate, const Building* live, const std::vector<StoredQualityWalk>& walks)>;
  struct Settings {
    Duration least_between{0};           ///< from a version that came by itself to the next round; changes wait for tick()
    Judge judge;                         ///< absent: every version comes into force
    std::function<ServerTime()> now;     ///< absent: nothing ever waits
    std::function<UnixTime()> wall_now;  ///< absent: versions bear the time 0
    bool gate = true;                    ///< points the rest of a survey contradicts stay out of its map; off only to measure it
  };

  BuildingKeeper(DatabaseDirectory& store, BuildingShelf& shelf, Run run, Settings settings);
  BuildingKeeper(DatabaseDirectory& store, BuildingShelf& shelf, Run run) : BuildingKeeper(store, shelf, std::move(run), Settings{}) {}

  void refresh(BuildingId id);
  /// The same at once, however new the newest version is; `ended` is called when a round that began after this call has ended, well
  /// or not, on whatever thread ended it; after stop() at once.
  void refresh(BuildingId id, std::function<void()> ended);
  /// Refreshes what has waited long enough, and keeps what pipelines learnt that sessions asked for; about once a second.
  void tick();
  /// No new reads from here on; what is being built is finished.
  void stop();
  /// Buildings that could not be made ready, with the reason.
  std::vector<std::pair<BuildingId, Fault>> failures() const;
  /// Nothing is being built and nothing waits for a build.
  bool settled() const;
  /// Waits until settled(). Never ends while somebody surveys: a server that starts waits for wait_for_first_round().
  void settle() const;
  /// Waits until each of `ids` has been built, or has failed, once; each was given to refresh() before.
  void wait_for_first_round(const std::vector<BuildingId>& ids) const;
  std::uint64_t rebuilds() const;

 private:
  struct Work {
    bool again = false;
    std::vector<std::function<void()>> waiting = {};  ///< for the end of the round under way
    std::vector<std::function<void()>> next = {};     ///< for the one after it
  };
  /// What one round read: the live version, and a candidate where one is to be judged.
  struct Round {
    BuildingRecord record;
    MapMaterial live;
    std::optional<MapMaterial> candidate;
    std::optional<std::uint64_t> expected_live;
    std::vector<StoredQualityWalk> walks;
  };
  void begin(BuildingId id);
  void read(BuildingId id, Result<BuildingDatabase*> database);
  Result<Round> read_round(BuildingDatabase& database);
  Result<void> renew(BuildingDatabase& database, const BuildingRecord& record, Round& round);
  void build(BuildingId id, Round round);
  void conclude(BuildingId id, std::shared_ptr<const Building> candidate, std::shared_ptr<const Building> live, Round round,
                MapJudgement judgement);
  void made_a_version(BuildingId id);
  void keep(const Building& building);
  void forget(BuildingId id);
  void prepare(const Building& building) const;
  void done(BuildingId id, std::optional<Fault> fault);
  bool conclude_round(BuildingId id, std::optional<Fault> fault, std::vector<std::function<void()>>& waited);
  UnixTime wall_now() const { return settings_.wall_now ? settings_.wall_now() : UnixTime{}; }

  DatabaseDirectory& store_;
  BuildingShelf& shelf_;
  const Run run_;
  const Settings settings_;
  mutable std::mutex mutex_;
  mutable std::condition_variable settled_;
  std::map<BuildingId, Work> working_;
  std::map<BuildingId, ServerTime> made_;     // when the newest version came by itself
  std::map<BuildingId, ServerTime> due_;      // waiting for their time
  std::map<BuildingId, Fault> failures_;
  std::set<BuildingId> once_done_;
  std::uint64_t rebuilds_ = 0;
  bool stopped_ = false;
};

}  // namespace wayfuse
