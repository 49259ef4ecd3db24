#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "admin/map_control.hpp"
#include "db/database_directory.hpp"
#include "server/buildings/building_shelf.hpp"
#include "server/quality/access_point_watch.hpp"

namespace wayfuse {

/// How many access points are in which state, for the metrics.
struct AccessPointCounts {
  std::uint64_t ok = 0, vanished = 0, moved = 0, power_changed = 0, fresh = 0;
  std::uint64_t distrusted = 0;
};

/// Access points of all buildings: gathers what sessions hear, reviews it now and then, keeps verdicts in the store, and says when
/// another set of transmitters is to be left out of the map.
///
/// At most a quarter of a survey's transmitters are distrusted by traffic alone: more at once is either a new network, which needs
/// a survey, or somebody's trick, and neither is for a program to decide. Thread: any.
class AccessPointDesk {
 public:
  static constexpr double kMostDistrusted = 0.25;

  AccessPointDesk(DatabaseDirectory& store, const BuildingShelf& shelf, std::function<UnixTime()> wall_now,
                  std::function<void(BuildingId)> distrust_changed);

  void hear(std::uint64_t session, const Building& building, const RssScan& scan, const FusedPosition& position);
  /// Judges what came since the last review; about once a minute.
  void review();
  void list(BuildingId building, MapControl::Done<std::vector<AccessPointView>> done);
  void trust(BuildingId building, Bssid bssid, AccessPointTrust trust, MapControl::Done<AccessPointView> done);
  AccessPointCounts counts() const;

 private:
  struct Watched {
    std::uint64_t survey_version = 0;
    std::shared_ptr<AccessPointWatch> watch;
    std::size_t reviewed_scans = 0;
    AccessPointCounts counts;
  };
  std::shared_ptr<AccessPointWatch> watch_of(BuildingId building) const;
  void review_one(BuildingId id, const std::shared_ptr<AccessPointWatch>& watch, BuildingDatabase& database);
  AccessPointView view_of(BuildingId id, AccessPointRecord record) const;

  DatabaseDirectory& store_;
  const BuildingShelf& shelf_;
  const std::function<UnixTime()> wall_now_;
  const std::function<void(BuildingId)> distrust_changed_;
  mutable std::mutex mutex_;
  std::map<BuildingId, Watched> watched_;
};

}  // namespace wayfuse
