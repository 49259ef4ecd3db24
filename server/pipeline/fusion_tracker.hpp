#pragma once

#include <functional>
#include <memory>

#include "server/locating/catalogue.hpp"
#include "server/pipeline/floor_vote.hpp"
#include "server/pipeline/odometry.hpp"
#include "server/pipeline/reading_gate.hpp"
#include "server/pipeline/recovery.hpp"
#include "server/pipeline/tracker.hpp"
#include "server/tracking/filter.hpp"
#include "server/tracking/heading_filter.hpp"

namespace wayfuse {

enum class MeasurementKind { kNone, kFix, kRanges, kField };

/// A spec's parts, prepared for one building. Immutable, shared by all its sessions.
struct PipelineParts {
  std::shared_ptr<const Site> site;
  BuildingPoint origin;                          ///< of the pipeline's frame, in the building's
  std::shared_ptr<const RadioMap> map;
  std::shared_ptr<const LocatorModel> locator;   ///< null: none
  std::shared_ptr<const MotionModel> motion;
  std::function<std::unique_ptr<Filter>()> make_filter;
  ReadingGateSettings readings;
  MeasurementKind measurement = MeasurementKind::kFix;
  double fix_sigma_m = 0.0;                      ///< 0 = the locator's own
  FloorVoteSettings floor;
  bool gnss = true;
  bool track_heading = false;                    ///< [P1 eq. 17], otherwise as reported
  HeadingFilterSettings heading;
  RecoverySettings recovery;
};

/// Evidence in, position out: predict to the evidence's own time, weigh, resample, correct.
///
/// A scan is applied where the phone was when its readings were heard: its fix is carried forward by what dead reckoning
/// covered since. Thread: confined to one session.
class FusionTracker final : public Tracker {
 public:
  FusionTracker(std::shared_ptr<const PipelineParts> parts, Random random, const std::optional<KnownStart>& start);
  FusionTracker(const FusionTracker& other);
  std::unique_ptr<Tracker> clone() const override { return std::make_unique<FusionTracker>(*this); }

  void feed(const MotionReport& motion) override;
  void feed(const RssScan& scan) override;
  void feed(const GnssFix& fix) override;
  std::optional<FusedPosition> position(PhoneTime at) const override;
  Fault why_no_fix() const override;

 private:
  double in_frame_rad(const MotionReport& motion) const;
  void turn(const MotionReport& motion, double dt_s);
  void advance(PhoneTime time);
  void apply(const Fix& fix);
  void apply_fix(BuildingPoint point, double sigma_m);
  bool agrees(BuildingPoint point, double sigma_m) const;
  void start_at(BuildingPoint point, double sigma_m);
  void align_heading();
  void guard_against_nan();
  Integrity integrity(PhoneTime at) const;

  std::shared_ptr<const PipelineParts> parts_;
  Random random_;
  std::unique_ptr<Locator> locator_;
  std::unique_ptr<Filter> filter_;
  ReadingGate gate_;
  FloorVote floor_;
  HeadingFilter heading_;
  Odometry odometry_;
  RssScan kept_;                                 // fresh readings of the newest scan

  std::optional<PhoneTime> newest_;              // evidence
  std::optional<PhoneTime> moved_to_;            // end of the newest motion report applied
  std::optional<PhoneTime> filtered_to_;         // the filter's own time
  std::optional<PhoneTime> newest_reading_;
  std::optional<double> reported_heading_rad_;   // in the frame, before any correction
  std::optional<HeadingReference> reference_;
  std::optional<Heading> start_heading_;
  struct Anchor {
    BuildingPoint track;
    BuildingPoint odometry;
  };
  std::optional<Anchor> anchor_;                 // where the present piece of track began
  double speed_mps_ = 0.0;
  bool at_rest_ = false;
  int misses_ = 0;
  int heard_scans_ = 0;
  std::optional<PhoneTime> restarted_;
  Contributions from_;
};

}  // namespace wayfuse
