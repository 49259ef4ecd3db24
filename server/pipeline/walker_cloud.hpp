#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/locating/locator.hpp"
#include "server/tracking/particle_cloud.hpp"
#include "server/tracking/walkable_area.hpp"
#include "wayfuse/proto/part.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {

/// Defaults: judged walk by walk on development walks (README.md, ablation).
struct WalkerSettings {
  int particles = 1000;
  double decorrelation_s = 5.0;    ///< memory of a scan's error: the next one, s later, repeats exp(-s / this) of it
  double outlier = 0.05;           ///< likelihood, against the best particle's, that no particle falls below
  double renewed = 0.005;          ///< share of particles a scan draws anew from its likelihood: the way back when lost
  double heading_sigma_rad = 0.3;  ///< of a particle's own compass error, at its start
  double heading_walk_rad_rts = 0.02;  ///< its random walk, per root second
  double stride_sigma = 0.06;      ///< of a particle's own stride, as a share
  double stray_strides = 0.15;     ///< share of particles with a stride far from the phone's: people and phones it was not made for
  double step_sigma_rtm = 0.35;    ///< m per root metre walked, per axis
  bool walkable = true;            ///< particles outside the walkable area fade away
  bool second_opinion = true;      ///< a track that a scan contradicts gets a rival (SecondOpinion)
  double floor_memory = 0.999;     ///< share of the floor belief a scan keeps; the rest is spread over all floors
  bool operator==(const WalkerSettings&) const = default;
};
WalkerSettings walker_settings(const PartSettings& settings);
/// The row of the catalogue: filter `walkers`.
PartDescription walkers_description();

/// How fresh walkers are turned against the phone's heading.
struct CompassPrior {
  double known_rad = 0.0;          ///< mean of their compass errors
  bool lost = false;               ///< any direction: the phone's heading has an unknown origin
};

/// Walkers: particles that go as the phone says, each with a compass error and a stride of its own, inside the walkable area.
///
/// Thread: confined to one session. Allocates nothing after construction.
class WalkerCloud {
 public:
  explicit WalkerCloud(const WalkerSettings& settings);

  struct Spread {
    BuildingPoint mean;
    Covariance covariance;
  };
  bool started() const { return started_; }
  /// Where walkers may be from now on; null = everywhere.
  void enter(const WalkableArea::Plan* plan) { plan_ = plan; }

  void start_about(BuildingPoint point, double sigma_m, const CompassPrior& compass, Random& random);
  /// From the locator's newest scan, carried on by what was walked since it was heard. Stays unstarted when it cannot say.
  void start_from(Locator& locator, FloorOrdinal floor, BuildingPoint carried, const CompassPrior& compass, Random& random);
  /// The frame's origin moved: everybody stays where he was in the building.
  void shift(double dx_m, double dy_m) { cloud_.shift(dx_m, dy_m); }
  /// New compass errors for everybody: the phone's heading changed its origin.
  void turn_about(const CompassPrior& compass, Random& random);
  /// One interval: displacement by the phone, its sigma per axis, the time spent on foot.
  void walk(double dx_m, double dy_m, double sigma_m, double on_foot_s, Random& random);
  /// Weighs by the scan where each walker was when it was heard, less what it repeats of the last one: errors e of scans whose
  /// correlation is `echo` weigh as (e - echo last)^2 / (1 - echo^2), which between two like errors is
  /// (log-likelihood - echo last one) / (1 + echo).
  struct Hearing {
    double agree = 1.0;            ///< share of the cloud, as it was, that the scan agrees with nearly as much as with the best walker
    double log_evidence = 0.0;     ///< of the whole scan, given the cloud as it was; up to a constant of the scan
  };
  Hearing weigh(const Locator& locator, FloorOrdinal floor, BuildingPoint carried, double echo);
  /// Share of the cloud that the newest scan should draw anew: more of a young one, as one scan's draw holds no walkers where the
  /// next ones say. None at all is a setting, too.
  double renewed() const;
  /// At most a half of the cloud.
  void renew(double share, Locator& locator, FloorOrdinal floor, BuildingPoint carried, const CompassPrior& compass, Random& random);
  /// Weighs by a point with a sigma per axis.
  void weigh(BuildingPoint point, double sigma_m);
  /// Normalised weights, resampled when too few walkers carry them.
  void settle(Random& random);
  Spread spread() const;
  const ParticleCloud& particles() const { return cloud_; }

 private:
  void walked_back(std::size_t begin, BuildingPoint carried, std::span<float> x_then_m, std::span<float> y_then_m) const;
  /// The k-th of `count` walkers who stand evenly among all; `offset`, below their number, moves them as a whole.
  std::size_t one_of(std::size_t count, std::size_t k, std::size_t offset) const { return (k * cloud_.size() + offset) / count; }
  void scatter(std::size_t count, std::size_t offset, BuildingPoint carried, const CompassPrior& compass, Random& random);
  void resample(Random& random);
  bool open(float x_m, float y_m) const { return !plan_ || plan_->open(x_m, y_m); }

  WalkerSettings settings_;
  ParticleCloud cloud_;
  const WalkableArea::Plan* plan_ = nullptr;
  double on_foot_s_ = 0.0;         // since copies were last kept apart
  int scans_ = 0;                  // heard since it started
  bool started_ = false;
};

}  // namespace wayfuse
