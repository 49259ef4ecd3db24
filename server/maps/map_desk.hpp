#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "admin/map_control.hpp"
#include "db/database_directory.hpp"
#include "server/maps/access_point_desk.hpp"
#include "server/buildings/building_keeper.hpp"
#include "server/quality/accuracy_model.hpp"

namespace wayfuse {

/// Radio maps as the operator handles them: builds, measures, compares, promotes; and what the survey promises.
///
/// Reading and writing happen on the store's thread, replays on a worker. Thread: any. Must outlive the tasks of both.
class MapDesk final : public MapControl {
 public:
  MapDesk(DatabaseDirectory& store, const BuildingShelf& shelf, BuildingKeeper& keeper, AccessPointDesk& access_points, BuildingKeeper::Run run,
          std::function<UnixTime()> wall_now);

  void build_map(BuildingId building, Done<std::uint64_t> done) override;
  void compare_map(BuildingId building, std::uint64_t version, const std::string& pipeline, Done<MapComparisonView> done) override;
  void promote_map(BuildingId building, const MapPromotion& promotion, Done<MapPromoted> done) override;
  void roll_back_map(BuildingId building, std::uint64_t by_key, const std::string& reason, Done<Publication> done) override;
  void expected_accuracy(BuildingId building, FloorOrdinal floor, Done<ExpectedAccuracy> done) override;
  void survey_plan(BuildingId building, FloorOrdinal floor, Done<SurveyPlan> done) override;
  void access_points(BuildingId building, Done<std::vector<AccessPointView>> done) override;
  void trust_access_point(BuildingId building, Bssid bssid, AccessPointTrust trust, Done<AccessPointView> done) override;
  void walks_changed(BuildingId building) override;
  Result<RecordingFacts> check_recording(const std::string& content) const override;

 private:
  struct Case;
  void gather(BuildingId building, std::uint64_t version, const std::string& pipeline, Done<std::shared_ptr<Case>> done);
  Result<std::shared_ptr<Case>> read_case(BuildingDatabase& database, std::uint64_t version, const std::string& pipeline) const;
  void publish(BuildingId building, const MapPromotion& promotion, std::optional<std::uint64_t> live, MapComparisonView comparison, Done<MapPromoted> done);
  void with_model(BuildingId building, Done<std::shared_ptr<const AccuracyModel>> done);

  DatabaseDirectory& store_;
  const BuildingShelf& shelf_;
  BuildingKeeper& keeper_;
  AccessPointDesk& access_points_;
  const BuildingKeeper::Run run_;
  const std::function<UnixTime()> wall_now_;
  // What a map's survey promises is found once a version and pipeline; who asks meanwhile waits for the same answer.
  struct Promise {
    std::shared_ptr<const Building> building;
    std::shared_ptr<const AccuracyModel> model;
    std::vector<Done<std::shared_ptr<const AccuracyModel>>> waiting;
  };
  std::mutex mutex_;
  std::map<BuildingId, Promise> promises_;
};

}  // namespace wayfuse
