#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/pipeline/field_tracker.hpp"

namespace wayfuse {

/// What scans say from now on, whatever is in them. A test changes it between two scans.
struct Told {
  BuildingPoint point;
  FloorOrdinal floor{0};           ///< its fix's, and the only one where places are told apart
  double sigma_m = 3.0;
  double most = 6.0;               ///< log-likelihood that a place, however far, loses
  double mismatch = 1.0;
  Duration heard_before{0};
  std::vector<FloorProbability> votes;
};

/// Says what it is told.
class ToldLocator final : public Locator {
 public:
  explicit ToldLocator(std::shared_ptr<const Told> told) : told_(std::move(told)) {}
  std::unique_ptr<Locator> clone() const override { return std::make_unique<ToldLocator>(*this); }
  std::optional<Fix> locate(const RssScan&) override { return Fix{{told_->point, told_->floor}, told_->sigma_m, 10}; }
  std::span<const FloorProbability> floors() const override { return told_->votes; }
  int transmitters_known() const override { return 10; }
  int transmitters_unknown() const override { return 0; }
  bool has_likelihood() const override { return true; }
  void add_log_likelihood(std::span<const float> x_m, std::span<const float> y_m, FloorOrdinal floor, std::span<float> out) const override {
    for (std::size_t i = 0; i < x_m.size(); ++i) {
      const double off = distance_m({static_cast<double>(x_m[i]), static_cast<double>(y_m[i])}, told_->point) / told_->sigma_m;
      out[i] -= static_cast<float>(floor == told_->floor ? std::min(told_->most, off * off / 2.0) : told_->most);
    }
  }
  bool draw(FloorOrdinal, Random& random, std::span<float> x_m, std::span<float> y_m) override {
    for (std::size_t i = 0; i < x_m.size(); ++i) {
      x_m[i] = static_cast<float>(told_->point.x_m + told_->sigma_m * random.normal());
      y_m[i] = static_cast<float>(told_->point.y_m + told_->sigma_m * random.normal());
    }
    return true;
  }
  Duration heard_before() const override { return told_->heard_before; }
  double mismatch() const override { return told_->mismatch; }

 private:
  std::shared_ptr<const Told> told_;
};

class ToldModel final : public LocatorModel {
 public:
  explicit ToldModel(std::shared_ptr<const Told> told) : told_(std::move(told)) {}
  std::unique_ptr<Locator> make() const override { return std::make_unique<ToldLocator>(told_); }

 private:
  std::shared_ptr<const Told> told_;
};

/// A phone in open space whose scans say what they are told.
class ToldPhone {
 public:
  explicit ToldPhone(std::uint64_t seed, const WalkerSettings& settings = {}, const std::optional<KnownStart>& start = {},
                     const Site& site = {}) {
    auto parts = std::make_shared<FieldTrackerParts>();
    parts->site = std::make_shared<Site>(site);
    parts->locator = std::make_shared<ToldModel>(told);
    parts->settings = settings;
    tracker_ = std::make_unique<FieldTracker>(parts, Random(seed), start);
  }
  void feed(MotionReport motion, double interval_s) {
    motion.time = PhoneTime(from_seconds(time_s_ += interval_s));
    motion.interval = from_seconds(interval_s);
    tracker_->feed(motion);
  }
  /// One report over `interval_s`, after `pause_s` without any.
  void go(double distance_m, double heading_rad, double interval_s, double climb_m = 0.0, double pause_s = 0.0) {
    time_s_ += pause_s;
    MotionReport motion;
    motion.heading = Heading::from_radians(heading_rad);
    motion.steps = distance_m > 0.0 ? 1 : 0;
    motion.step_length_m = distance_m;
    motion.at_rest = distance_m == 0.0;
    if (climb_m != 0.0) motion.climb_m = climb_m;
    feed(motion, interval_s);
  }
  FusedPosition hear() {
    tracker_->feed(RssScan{PhoneTime(from_seconds(time_s_)), {{Bssid{1}, -50.0, Duration{0}, 2437, {}, {}}}});
    return position();
  }
  FusedPosition hear(BuildingPoint point) {
    told->point = point;
    return hear();
  }
  FusedPosition position() const { return *tracker_->position(PhoneTime(from_seconds(time_s_))); }
  double time_s() const { return time_s_; }

  std::shared_ptr<Told> told = std::make_shared<Told>();

 private:
  std::unique_ptr<FieldTracker> tracker_;
  double time_s_ = 0.0;
};

}  // namespace wayfuse
