#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "db/access_point_record.hpp"
#include "db/radio_map_record.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// A radio map held against the one in force, on the quality walks both were replayed on.
struct MapComparisonView {
  std::uint64_t version = 0;
  std::optional<std::uint64_t> live;       ///< absent = nothing is in force
  std::string pipeline;
  std::string verdict;                     ///< `better`, `same`, `worse`, `unknown`
  std::vector<std::string> reasons;
  std::vector<std::string> remarks;        ///< of the build: what was left out and why
  PooledQuality candidate;
  PooledQuality in_force;
  double difference_m = 0.0;               ///< of the mean errors, candidate minus live; NaN where a side never answers
  double low_m = 0.0;                      ///< 95 % interval, bootstrap over walks
  double high_m = 0.0;
  struct Walk {
    std::uint64_t id = 0;
    std::string name;
    std::optional<MapQuality> candidate;
    std::optional<MapQuality> in_force;
  };
  std::vector<Walk> walks;
};

struct MapPromotion {
  std::uint64_t version = 0;
  std::optional<std::uint64_t> expected_live = {};  ///< refused when another one is live by now; absent = whatever is
  bool override_gate = false;              ///< although it is worse; needs a reason
  std::uint64_t by_key = 0;
  std::string reason = {};
};
/// Either the publication, or why not: the gate said worse.
struct MapPromoted {
  std::optional<Publication> publication;
  MapComparisonView comparison;
};

/// A floor as the survey covers it, and the error to expect there. Cell (column, row) is number row * columns + column, its
/// middle at origin + (column + 1/2, row + 1/2) * cell.
struct ExpectedAccuracy {
  FloorOrdinal floor;
  double origin_x_m = 0.0;
  double origin_y_m = 0.0;
  double cell_m = 2.0;
  int columns = 0;
  int rows = 0;
  std::vector<std::uint32_t> points;       ///< reference points in the cell
  std::vector<std::optional<double>> expected_m;  ///< median error of a tracked phone; absent = outside or nothing known
  std::optional<double> median_m;          ///< over the cells where phones can be
  std::string basis;                       ///< how it was found, with counts
};

/// What to walk next, best first; each figure counts the walks before it as done.
struct SurveyPlan {
  FloorOrdinal floor;
  std::optional<double> median_now_m;
  struct Walk {
    std::vector<BuildingPoint> path;
    double length_m = 0.0;
    double median_after_m = 0.0;
    std::string why;
  };
  std::vector<Walk> walks;
};

/// An access point's health, and where to survey again for its sake.
struct AccessPointView {
  AccessPointRecord record;
  bool on_map = false;                     ///< the survey knows it
  std::vector<Place> resurvey;             ///< where it was heard well, thinned out
};

/// The window `admin` has on what builds, measures and watches radio maps; `server` implements it.
///
/// Thread: any; `done` is called once, on any thread, when the work is.
class MapControl {
 public:
  template <typename T>
  using Done = std::function<void(Result<T>)>;
  virtual ~MapControl() = default;

  /// Builds a version from the survey as it stands, keeps it and replays all quality walks on it; answers its number.
  virtual void build_map(BuildingId building, Done<std::uint64_t> done) = 0;
  /// Empty pipeline = the building's own; figures of another are not kept.
  virtual void compare_map(BuildingId building, std::uint64_t version, const std::string& pipeline, Done<MapComparisonView> done) = 0;
  virtual void promote_map(BuildingId building, const MapPromotion& promotion, Done<MapPromoted> done) = 0;
  virtual void roll_back_map(BuildingId building, std::uint64_t by_key, const std::string& reason, Done<Publication> done) = 0;
  /// kNotFound for a floor nobody surveyed and nobody drew.
  virtual void expected_accuracy(BuildingId building, FloorOrdinal floor, Done<ExpectedAccuracy> done) = 0;
  virtual void survey_plan(BuildingId building, FloorOrdinal floor, Done<SurveyPlan> done) = 0;
  virtual void access_points(BuildingId building, Done<std::vector<AccessPointView>> done) = 0;
  virtual void trust_access_point(BuildingId building, Bssid bssid, AccessPointTrust trust, Done<AccessPointView> done) = 0;
  /// A quality walk came or went: the live map is measured anew, in its own time.
  virtual void walks_changed(BuildingId building) = 0;
  /// Reads a recording as the server will replay it: what is wrong with it, or the model and time it names.
  struct RecordingFacts {
    std::string device_model;
    UnixTime recorded_at;
  };
  virtual Result<RecordingFacts> check_recording(const std::string& content) const = 0;
};

}  // namespace wayfuse
