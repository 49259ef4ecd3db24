#pragma once

#include <functional>
#include <memory>

#include "server/locating/catalogue.hpp"
#include "server/pipeline/corrector.hpp"
#include "server/pipeline/field_measurement.hpp"
#include "server/pipeline/floor_vote.hpp"
#include "server/pipeline/odometry.hpp"
#include "server/pipeline/reading_gate.hpp"
#include "server/pipeline/recovery.hpp"
#include "server/pipeline/tracker.hpp"
#include "server/tracking/filter.hpp"
#include "server/tracking/heading_filter.hpp"

namespace wayfuse {

enum class MeasurementKind { kNone, kFix, kRanges, kField };
enum class GnssUse { kNone, kFix, kStart };

struct FixSettings {
  double sigma_m = 0.0;            ///< 0 = the locator's own
  double sigma_scale = 1.0;        ///< factor on the locator's own
  double gate_sigmas = 0.0;        ///< a fix farther off is not applied; 0 = every fix is
};
struct FieldSettings {
  double weight = 1.0;             ///< power of the likelihood
  double outlier = 0.02;           ///< likelihood, against the best particle's, that no particle falls below
};
/// A phone's value taken as a measurement of a state with velocity [P5 eq. 2].
struct VelocityUse {
  bool on = false;
  double sigma = 0.0;              ///< 0 = as the phone states it
};

/// A spec's parts, prepared for one building. Immutable, shared by all its sessions.
struct PipelineParts {
  PipelineSpec spec;
  std::shared_ptr<const Site> site;
  BuildingPoint origin;                          ///< of the pipeline's frame, in the building's
  std::shared_ptr<const RadioMap> map;
  std::shared_ptr<const LocatorModel> locator;   ///< null: none
  std::shared_ptr<const MotionModel> motion;
  std::function<std::unique_ptr<Filter>()> make_filter;
  ReadingGateSettings readings;
  MeasurementKind measurement = MeasurementKind::kFix;
  FixSettings fix;
  FieldSettings field;
  double range_sigma_scale = 1.0;
  FloorVoteSettings floor;
  GnssUse gnss = GnssUse::kFix;
  double gnss_start_s = 20.0;                    ///< kStart: fixes count for so long, then never again
  VelocityUse speed;
  VelocityUse azimuth;
  bool resolved = false;                         ///< azimuth and speed as one velocity in two parts [P5 eq. 4]
  bool track_heading = false;                    ///< [P1 eq. 17], otherwise as reported
  HeadingFilterSettings heading;
  RecoverySettings recovery;
  std::shared_ptr<const Corrector> corrector;    ///< null: none
};

/// Evidence in, position out: predict to the evidence's own time, weigh, resample, correct.
///
/// A scan is applied where the phone was when its readings were heard: its fix is carried forward by what dead reckoning
/// covered since. Thread: confined to one session.
class FusionTracker final : public Tracker {
 public:
  FusionTracker(std::shared_ptr<const PipelineParts> parts, Random random, const std::optional<KnownStart>& start);
  FusionTracker(const FusionTracker& other);
  /// Goes on where `older`, of the same spec, stands, over another map of the same building.
  FusionTracker(std::shared_ptr<const PipelineParts> parts, const FusionTracker& older);
  std::unique_ptr<Tracker> clone() const override { return std::make_unique<FusionTracker>(*this); }

  void feed(const MotionReport& motion) override;
  void feed(const RssScan& scan) override;
  void feed(const GnssFix& fix) override;
  std::optional<FusedPosition> position(PhoneTime at) const override;
  Fault why_no_fix() const override;
  std::vector<WeightedPlace> cloud(std::size_t most) const override;
  std::string left_out(const ScanReading& reading) const override;
  std::vector<std::string> doubts(PhoneTime at) const override;

  /// Of the newest applied fix, for training; absent when it moved nothing.
  std::optional<BackPropagation::Inputs> newest_correction_inputs() const { return correction_inputs_; }
  const PipelineParts& parts() const { return *parts_; }
  /// The session's locator, for reports.
  const Locator* locator() const { return locator_.get(); }

 private:
  double in_frame_rad(const MotionReport& motion) const;
  void turn(const MotionReport& motion, double dt_s);
  void advance(PhoneTime time);
  void measure_velocity(const MotionReport& motion, const Motion& moved);
  void apply(const Fix& fix, BuildingPoint carried);
  void teach(BuildingPoint carried);
  void apply_fix(BuildingPoint point, double sigma_m);
  void apply_ranges(BuildingPoint carried);
  void apply_field(BuildingPoint carried);
  bool agrees(BuildingPoint point, double sigma_m, double sigmas) const;
  void note_correction(const GaussianState& before, BuildingPoint point, double sigma_m);
  void start_at(BuildingPoint point, double sigma_m);
  void align_heading();
  void guard_against_nonsense();
  Integrity integrity(PhoneTime at) const;
  bool stale(PhoneTime at) const;
  bool foreign() const;
  bool restarted_lately(PhoneTime at) const;

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
  std::optional<PhoneTime> first_gnss_;
  std::optional<BackPropagation::Inputs> correction_inputs_;
  BuildingPoint correction_;                     // what the corrector adds to the estimate
  Contributions from_;
  FieldScratch field_scratch_;                   // not part of the state
};

}  // namespace wayfuse
