#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "db/building_database.hpp"
#include "server/buildings/doubtful_point.hpp"
#include "server/pipeline/tracker.hpp"

namespace wayfuse {

/// An immutable snapshot of a building, ready to track in: what sessions hold while a newer one is made.
class Building {
 public:
  /// Builds the radio map and the building's own pipeline; other presets are made when first asked for. Points that the rest
  /// of the survey contradicts stay out of every pipeline's map (and stay in the store): doubts(). `corrector`: what the
  /// building's own pipeline learnt from this very survey before; empty = it learns anew.
  static Result<std::shared_ptr<const Building>> make(BuildingRecord record, std::vector<ReferencePoint> survey, bool gate = true,
                                                      std::string corrector = {});

  const BuildingRecord& record() const { return record_; }
  const std::shared_ptr<const Site>& site() const { return site_; }
  /// Empty name = the building's own pipeline. Thread: any.
  Result<std::shared_ptr<const TrackerFactory>> pipeline(const std::string& name) const;
  /// Of the building's own pipeline: what it could not prepare, and what it learnt from the survey (to be kept; empty = nothing).
  std::vector<std::string> remarks() const;
  std::string learnt() const;
  /// Points left out of the map, ascending by their index in the survey as stored, and why.
  std::span<const DoubtfulPoint> doubts() const { return doubts_; }
  /// Transmitters this survey knows, ascending; for resolving a session without a building id.
  std::span<const Bssid> transmitters() const { return transmitters_; }

 private:
  Building() = default;
  BuildingRecord record_;
  std::shared_ptr<const Site> site_;
  std::vector<DoubtfulPoint> doubts_;
  std::vector<Bssid> transmitters_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::shared_ptr<const TrackerFactory>> pipelines_;
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

}  // namespace wayfuse
