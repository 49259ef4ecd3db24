#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/locating/catalogue.hpp"
#include "server/pipeline/odometry.hpp"
#include "server/pipeline/tracker.hpp"
#include "server/tracking/particle_cloud.hpp"
#include "server/tracking/walkable_area.hpp"

namespace wayfuse {

/// Particles that walk as the phone says, each with a compass error and a stride of its own, inside the walkable area, weighed by
/// a locator's likelihood field. Defaults: judged walk by walk on development walks (README.md, ablation).
struct FieldTrackerSettings {
  int particles = 1000;
  double weight = 0.35;            ///< power of a scan's likelihood: scans of one walk err together
  double outlier = 0.02;           ///< likelihood, against the best particle's, that no particle falls below
  double renewed = 0.01;           ///< share of particles a scan draws anew from its likelihood: the way back when lost
  double heading_sigma_rad = 0.2;  ///< of a particle's own compass error, at its start
  double heading_walk_rad_rts = 0.02;  ///< its random walk, per root second
  double stride_sigma = 0.06;      ///< of a particle's own stride, as a share
  double step_sigma_rtm = 0.25;    ///< m per root metre walked, per axis
  bool walkable = true;            ///< particles outside the walkable area fade away
  double floor_memory = 0.999;     ///< share of the floor belief a scan keeps; the rest is spread over all floors
};

FieldTrackerSettings field_tracker_settings(const PartSettings& settings);
/// The row of the catalogue: filter `walkers`.
PartDescription field_tracker_description();

/// A building prepared for field trackers. Immutable, shared by all its sessions.
struct FieldTrackerParts {
  std::shared_ptr<const Site> site;
  BuildingPoint origin;            ///< of the pipeline's frame, in the building's
  bool empty_map = false;
  std::shared_ptr<const LocatorModel> locator;
  WalkableArea walkable;           ///< in the pipeline's frame
  FieldTrackerSettings settings;
};

/// The project's own tracker.
///
/// A scan is weighed where each particle was when its readings were heard. Successive scans err together, so each counts for less
/// than its own likelihood says; at rest a new scan says nothing new. Floors are a recursive belief beside the cloud.
/// Thread: confined to one session.
class FieldTracker final : public Tracker {
 public:
  FieldTracker(std::shared_ptr<const FieldTrackerParts> parts, Random random, const std::optional<KnownStart>& start);
  FieldTracker(const FieldTracker& other);

  void feed(const MotionReport& motion) override;
  void feed(const RssScan& scan) override;
  void feed(const GnssFix& fix) override;
  std::optional<FusedPosition> position(PhoneTime at) const override;
  Fault why_no_fix() const override;
  std::unique_ptr<Tracker> clone() const override { return std::make_unique<FieldTracker>(*this); }

 private:
  struct Spread {
    double x_m = 0.0;
    double y_m = 0.0;
    Covariance covariance;
  };
  double in_frame_rad(const MotionReport& motion) const;
  void walk(const MotionReport& motion, double dt_s, double dx_m, double dy_m);
  void draw(std::span<float> x_m, std::span<float> y_m);
  void start_from_scan(BuildingPoint carried);
  void start_about(BuildingPoint point, double sigma_m);
  void scatter_columns(std::size_t begin, std::size_t end, BuildingPoint carried);
  void weigh(BuildingPoint carried);
  void renew(double share, BuildingPoint carried);
  void settle();
  void resample();
  bool believe_floors();
  Spread spread() const;
  bool open(float x_m, float y_m) const { return !plan_ || plan_->open(x_m, y_m); }
  bool informative();

  std::shared_ptr<const FieldTrackerParts> parts_;
  Random random_;
  std::unique_ptr<Locator> locator_;
  ParticleCloud cloud_;
  std::vector<float> x_then_m_;    ///< scratch: particles when the scan was heard
  std::vector<float> y_then_m_;
  std::vector<float> gained_;
  std::vector<FloorProbability> floors_;
  std::optional<FloorOrdinal> floor_;
  const WalkableArea::Plan* plan_ = nullptr;
  Odometry odometry_;
  bool started_ = false;
  std::optional<PhoneTime> newest_;
  std::optional<PhoneTime> moved_to_;
  std::optional<PhoneTime> newest_reading_;
  std::optional<Heading> start_heading_;
  std::optional<HeadingReference> reference_;
  double heading_rad_ = 0.0;
  double heading_sigma_rad_ = 0.0;
  double speed_mps_ = 0.0;
  double since_jitter_s_ = 0.0;
  bool at_rest_ = false;
  int scans_at_rest_ = 0;
  int foreign_floor_ = 0;
  int heard_scans_ = 0;
  Contributions from_;
};

std::shared_ptr<const TrackerFactory> make_field_pipeline(const PipelineSpec& spec, std::shared_ptr<const FieldTrackerParts> parts);

}  // namespace wayfuse
