#include <algorithm>
#include <cmath>

#include "server/pipeline/field_tracker.hpp"
#include "server/pipeline/reckoning.hpp"
#include "server/pipeline/weighted_places.hpp"

// What a field tracker says of itself.

namespace wayfuse {
namespace {

constexpr double kIdleDriftMps = 0.5;
constexpr double kWithoutMotionMps = 1.3;    // a phone that reports no motion at all may walk as anybody does
// Of the cloud's root mean square radius: a Gaussian cloud would have 1.07 and 1.73, real errors have longer tails. Fitted on
// the folds of the survey walks and held against the test walks, once for all buildings: what differs between them is in the cloud.
constexpr double kRadius68 = 0.86;
constexpr double kRadius95 = 2.2;
constexpr double kLeastSpread_m = 1.0;
constexpr double kDoubtPower = 0.3;
constexpr double kDisputedS = 5.0;
constexpr double kStrange = 2.5;               // mismatch: the scan belongs to no surveyed place

const char* words_for(Trick trick) {
  switch (trick) {
    case Trick::kCopied: return "scans repeat an older one as if heard anew";
    case Trick::kElsewhere: return "scans contradict a track that others agreed with: carried off, or another place relayed";
    case Trick::kOutOfPlace: return "strong access points do not belong where the rest of the scan was heard";
  }
  return "";
}

}  // namespace

Integrity FieldTracker::integrity(PhoneTime at) const {
  if (watch_.suspect(at)) return Integrity::kSuspect;
  return stale(at) || foreign() || disputed(at) || implausible_ > 0 || mismatch_ > kStrange ? Integrity::kDegraded : Integrity::kOk;
}

bool FieldTracker::stale(PhoneTime at) const { return !newest_reading_ || seconds(at - *newest_reading_) > kStaleScanS; }

bool FieldTracker::disputed(PhoneTime at) const { return disputed_at_ && seconds(at - *disputed_at_) < kDisputedS; }

bool FieldTracker::foreign() const {
  return from_.transmitters_used < 3 || from_.transmitters_unknown > 3 * from_.transmitters_used;
}

std::vector<std::string> FieldTracker::doubts(PhoneTime at) const {
  std::vector<std::string> reasons;
  if (watch_.suspect(at)) reasons.emplace_back(words_for(watch_.trick()));
  if (stale(at)) reasons.emplace_back(kStaleWords);
  if (disputed(at)) reasons.emplace_back("satellite fixes are far from where scans agree that the phone is");
  if (foreign()) reasons.emplace_back("fewer than 3 access points of the newest scan are known, or more than three times as many are not");
  if (implausible_ > 0) reasons.push_back(std::to_string(implausible_) + " strong access points are not at home around here");
  if (mismatch_ > kStrange) reasons.emplace_back("the scans are like no surveyed place");
  return reasons;
}

std::optional<FusedPosition> FieldTracker::position(PhoneTime at) const {
  if (!cloud_.started() || !floor_) return std::nullopt;
  const WalkerCloud::Spread now = cloud_.spread();
  if (!is_near(now.mean)) return std::nullopt;
  const double idle_s = newest_ ? std::max(0.0, seconds(at - *newest_)) : 0.0;
  const double drift_m = at_rest_ || idle_s < 1.0 ? 0.0 : (moved_to_ ? kIdleDriftMps : kWithoutMotionMps) * idle_s;
  const double radius_m = std::sqrt(now.covariance.xx_m2 + now.covariance.yy_m2);
  FusedPosition position;
  position.valid_at = at;
  position.building = parts_->site->building;
  position.place = {plus(now.mean, parts_->origin), *floor_};
  if (parts_->site->georeference) position.geo = parts_->site->georeference->to_geo(position.place.point);
  position.floors = floors_;
  position.covariance = {now.covariance.xx_m2 + drift_m * drift_m, now.covariance.xy_m2, now.covariance.yy_m2 + drift_m * drift_m};
  // Scans counted for what they do not repeat leave a cloud as wide as the error; a scan that fits nothing widens it.
  const double doubt_m = std::hypot(radius_m, kLeastSpread_m) * std::pow(std::max(1.0, mismatch_), kDoubtPower);
  position.radius68_m = std::hypot(kRadius68 * doubt_m, drift_m);
  position.radius95_m = std::max(position.radius68_m, std::hypot(kRadius95 * doubt_m, 2.0 * drift_m));
  position.heading = Heading::from_radians(heading_rad_);
  position.heading_sigma_rad = stated_heading_sigma_rad(moved_to_ ? std::hypot(heading_sigma_rad_, parts_->settings.heading_sigma_rad) : kLostHeadingRad);
  position.speed_mps = stated_speed_mps(speed_mps_);
  position.radio_map_version = parts_->site->radio_map_version;
  position.from = from_;
  position.from.scan_age = newest_reading_ ? std::max(Duration{0}, at - *newest_reading_) : Duration{0};
  position.integrity = integrity(at);
  return position;
}

std::vector<WeightedPlace> FieldTracker::cloud(std::size_t most) const {
  if (!cloud_.started()) return {};
  return weighted_places(cloud_.particles(), parts_->origin, most);
}

Fault FieldTracker::why_no_fix() const {
  if (parts_->empty_map) return {FaultCode::kEmptyRadioMap, "", "the building has no fingerprints yet"};
  if (heard_scans_ == 0) return {FaultCode::kNotFound, "", "no fresh scan heard yet"};
  return {FaultCode::kNoKnownAccessPoint, "", "no access point of the newest scan is on the map"};
}

}  // namespace wayfuse
