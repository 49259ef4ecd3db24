#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "server/locating/catalogue.hpp"
#include "server/pipeline/odometry.hpp"
#include "server/pipeline/scan_watch.hpp"
#include "server/pipeline/second_opinion.hpp"
#include "server/pipeline/tracker.hpp"
#include "server/pipeline/walker_cloud.hpp"

namespace wayfuse {

/// A building prepared for field trackers. Immutable, shared by all its sessions.
struct FieldTrackerParts {
  std::shared_ptr<const Site> site;
  BuildingPoint origin;            ///< of the pipeline's frame, in the building's
  bool empty_map = false;
  std::shared_ptr<const LocatorModel> locator;
  WalkableArea walkable;           ///< in the pipeline's frame
  WalkerSettings settings;
};

/// The project's own tracker.
///
/// A scan is weighed where each particle was when its readings were heard. Successive scans err together, so each counts for
/// what it does not repeat; at rest a new scan says nothing new. Floors are a recursive belief beside the cloud.
/// Thread: confined to one session.
class FieldTracker final : public Tracker {
 public:
  FieldTracker(std::shared_ptr<const FieldTrackerParts> parts, Random random, const std::optional<KnownStart>& start);
  FieldTracker(const FieldTracker& other);
  /// Goes on where `older` stands, over another map of the same building.
  FieldTracker(std::shared_ptr<const FieldTrackerParts> parts, const FieldTracker& older);

  void feed(const MotionReport& motion) override;
  void feed(const RssScan& scan) override;
  void feed(const GnssFix& fix) override;
  std::optional<FusedPosition> position(PhoneTime at) const override;
  Fault why_no_fix() const override;
  std::vector<WeightedPlace> cloud(std::size_t most) const override;
  std::vector<std::string> doubts(PhoneTime at) const override;
  std::unique_ptr<Tracker> clone() const override { return std::make_unique<FieldTracker>(*this); }
  const FieldTrackerParts& parts() const { return *parts_; }

 private:
  static constexpr double kFits = 1.3;  ///< mismatch of a scan that knows where on surveyed ground it was heard

  double in_frame_rad(const MotionReport& motion) const;
  CompassPrior compass() const;
  void walk(const MotionReport& motion, double dt_s, double dx_m, double dy_m);
  bool believe_floors();
  bool informative();
  double echo() const;
  bool far_off(BuildingPoint point, double sigma_m) const;
  bool step_out(BuildingPoint point, double sigma_m);
  bool elsewhere(double agreeing);
  bool second_opinion(double log_evidence, const Fix& fix, BuildingPoint carried);
  double outdone(double log_evidence) const;
  bool give_up(const Fix& fix, BuildingPoint carried);
  void change_places();
  void stand_on(FloorOrdinal floor);
  void take_stock(const RssScan& scan, BuildingPoint carried);
  bool astray(const Fix& fix, BuildingPoint carried);
  Integrity integrity(PhoneTime at) const;
  bool stale(PhoneTime at) const;
  bool disputed(PhoneTime at) const;
  bool foreign() const;

  std::shared_ptr<const FieldTrackerParts> parts_;
  Random random_;
  std::unique_ptr<Locator> locator_;
  WalkerCloud cloud_;
  SecondOpinion second_;
  bool contradicted_ = false;      ///< the track, by the newest scan
  std::vector<FloorProbability> floors_;
  std::vector<FloorProbability> votes_;         ///< for floors, by the newest scan
  std::vector<FloorProbability> votes_before_;  ///< by the one before: what the newest repeats of them is not counted again
  std::optional<FloorOrdinal> floor_;
  Odometry odometry_;
  std::optional<PhoneTime> newest_;
  std::optional<PhoneTime> moved_to_;
  std::optional<PhoneTime> newest_reading_;
  std::optional<PhoneTime> weighed_to_;  ///< when the readings weighed last were heard
  std::optional<Heading> start_heading_;
  std::optional<HeadingReference> reference_;
  double heading_rad_ = 0.0;
  double heading_sigma_rad_ = 0.0;
  double speed_mps_ = 0.0;
  bool at_rest_ = false;
  int scans_at_rest_ = 0;
  int fixes_at_rest_ = 0;
  int foreign_floor_ = 0;
  int heard_scans_ = 0;
  int scans_elsewhere_ = 0;        ///< in a row
  double climbed_m_ = 0.0;         ///< by the barometer, of late
  std::optional<PhoneTime> gnss_at_;
  std::optional<PhoneTime> scan_agreed_at_;  ///< the newest that knew where it was heard, and did not contradict the track
  std::optional<PhoneTime> disputed_at_;     ///< the newest satellite fix that such scans deny
  bool outdoors_ = false;          ///< off the plan by a good satellite fix: no walls, and no scans, until it falls silent
  int fixes_outside_ = 0;          ///< in a row
  int fixes_elsewhere_ = 0;        ///< in a row
  double mismatch_ = 1.0;          ///< smoothed over scans
  int implausible_ = 0;            ///< strong radios of the newest scan that the survey does not hear about here
  ScanWatch watch_;
  Contributions from_;
};

std::shared_ptr<const TrackerFactory> make_field_pipeline(const PipelineSpec& spec, std::shared_ptr<const FieldTrackerParts> parts);

}  // namespace wayfuse
