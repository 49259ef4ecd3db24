#include <algorithm>
#include <cmath>

#include "server/pipeline/fusion_tracker.hpp"
#include "server/pipeline/reckoning.hpp"
#include "server/pipeline/weighted_places.hpp"

// What a fusion tracker says of itself.

namespace wayfuse {
namespace {

constexpr double kIdleDriftMps = 0.5;    // how fast an answer ages after the newest evidence
constexpr double kSuspectS = 5.0;

}  // namespace

Integrity FusionTracker::integrity(PhoneTime at) const {
  if (misses_ >= 2 || restarted_lately(at)) return Integrity::kSuspect;
  if (!locator_) return Integrity::kOk;
  return stale(at) || foreign() || misses_ > 0 ? Integrity::kDegraded : Integrity::kOk;
}

bool FusionTracker::restarted_lately(PhoneTime at) const { return restarted_ && seconds(at - *restarted_) < kSuspectS; }

bool FusionTracker::stale(PhoneTime at) const { return !newest_reading_ || seconds(at - *newest_reading_) > kStaleScanS; }

bool FusionTracker::foreign() const {
  return from_.transmitters_used < 3 || from_.transmitters_unknown > 3 * from_.transmitters_used;
}

std::vector<std::string> FusionTracker::doubts(PhoneTime at) const {
  std::vector<std::string> reasons;
  if (misses_ > (locator_ ? 0 : 1)) reasons.push_back(std::to_string(misses_) + " fixes in a row lie too far from the track");
  if (restarted_lately(at)) reasons.emplace_back("the track began anew a moment ago: fixes had left it");
  if (locator_ && stale(at)) reasons.emplace_back(kStaleWords);
  if (locator_ && foreign()) reasons.emplace_back("fewer than 3 access points of the newest scan are known, or more than three times as many are not");
  return reasons;
}

std::optional<FusedPosition> FusionTracker::position(PhoneTime at) const {
  if (!filter_->started() || !floor_.started()) return std::nullopt;
  const GaussianState belief = filter_->estimate();
  const double idle_s = newest_ ? std::max(0.0, seconds(at - *newest_)) : 0.0;
  const double drift_m = at_rest_ || idle_s < 1.0 ? 0.0 : kIdleDriftMps * idle_s;
  FusedPosition position;
  position.valid_at = at;
  position.building = parts_->site->building;
  position.place = {plus(plus({belief.mean.x_m, belief.mean.y_m}, correction_), parts_->origin), floor_.floor()};
  if (parts_->site->georeference) position.geo = parts_->site->georeference->to_geo(position.place.point);
  position.floors = floor_.probabilities();
  position.covariance = {belief.covariance[0] + drift_m * drift_m, belief.covariance[1], belief.covariance[5] + drift_m * drift_m};
  position.radius68_m = std::hypot(filter_->radius_m(0.68), drift_m);
  position.radius95_m = std::max(position.radius68_m, std::hypot(filter_->radius_m(0.95), 2.0 * drift_m));
  if (heading_.started()) {
    position.heading = Heading::from_radians(heading_.heading_rad());
    position.heading_sigma_rad = stated_heading_sigma_rad(std::sqrt(heading_.variance_rad2()));
  } else {
    position.heading = Heading::from_vector(belief.mean.vx_mps, belief.mean.vy_mps);
    position.heading_sigma_rad = kLostHeadingRad;
  }
  position.speed_mps = stated_speed_mps(moved_to_ ? speed_mps_ : std::hypot(belief.mean.vx_mps, belief.mean.vy_mps));
  position.radio_map_version = parts_->site->radio_map_version;
  position.integrity = integrity(at);
  position.from = from_;
  position.from.scan_age = newest_reading_ ? std::max(Duration{0}, at - *newest_reading_) : Duration{0};
  return position;
}

std::vector<WeightedPlace> FusionTracker::cloud(std::size_t most) const {
  const ParticleCloud* particles = static_cast<const Filter&>(*filter_).cloud();
  if (!particles || !filter_->started()) return {};
  return weighted_places(*particles, plus(correction_, parts_->origin), most);
}

std::string FusionTracker::left_out(const ScanReading& reading) const {
  if (!locator_) return "this pipeline uses no scans";
  if (std::ranges::find(kept_.readings, reading) != kept_.readings.end()) return {};
  return gate_.why_not(reading, kept_.time - reading.age);
}

Fault FusionTracker::why_no_fix() const {
  if (!locator_) return {FaultCode::kNotFound, "", "this pipeline uses no scans and was not told where it starts"};
  if (parts_->map->empty()) return {FaultCode::kEmptyRadioMap, "", "the building has no fingerprints yet"};
  if (heard_scans_ == 0) return {FaultCode::kNotFound, "", "no fresh scan heard yet"};
  return {FaultCode::kNoKnownAccessPoint, "", "no access point of the newest scan is on the map"};
}

}  // namespace wayfuse
