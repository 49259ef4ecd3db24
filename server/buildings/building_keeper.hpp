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

namespace wayfuse {

/// Keeps the shelf true to the store: reads a changed building on the store's thread, builds its snapshot on a worker and
/// swaps it in. Changes that come while one is being built are taken together in the next round.
///
/// Thread: any; one mutex, never held while calling out. Must outlive the store's and the workers' tasks: see settle().
class BuildingKeeper {
 public:
  /// Runs a task some time later, off the caller's thread (or inline, in a simulation).
  using Run = std::function<void(std::function<void()>)>;

  /// `gate`: whether points the rest of a survey contradicts stay out of its map; off only to measure what it is worth.
  BuildingKeeper(DatabaseDirectory& store, BuildingShelf& shelf, Run run, bool gate = true);

  void refresh(BuildingId id);
  /// No new reads from here on; what is being built is finished.
  void stop();
  /// Buildings that could not be made ready, with the reason.
  std::vector<std::pair<BuildingId, Fault>> failures() const;
  /// Nothing is being built and nothing waits.
  bool settled() const;
  /// Waits until settled(). Never ends while somebody surveys: a server that starts waits for wait_for_first_round().
  void settle() const;
  /// Waits until each of `ids` has been built, or has failed, once; each was given to refresh() before.
  void wait_for_first_round(const std::vector<BuildingId>& ids) const;
  std::uint64_t rebuilds() const;

 private:
  struct Work {
    bool again = false;
  };
  struct Survey {
    BuildingRecord record;
    std::vector<ReferencePoint> points;
    std::string corrector;         // of the building's own pipeline, if it learnt it from these points
  };
  void begin(BuildingId id);
  void read(BuildingId id, Result<BuildingDatabase*> database);
  void build(BuildingId id, Survey survey);
  void keep(const Building& building, const std::string& stored);
  void done(BuildingId id, std::optional<Fault> fault);
  static Result<Survey> read_survey(BuildingDatabase& database);

  DatabaseDirectory& store_;
  BuildingShelf& shelf_;
  const Run run_;
  const bool gate_;
  mutable std::mutex mutex_;
  mutable std::condition_variable settled_;
  std::map<BuildingId, Work> working_;
  std::map<BuildingId, Fault> failures_;
  std::set<BuildingId> once_done_;
  std::uint64_t rebuilds_ = 0;
  bool stopped_ = false;
};

}  // namespace wayfuse
