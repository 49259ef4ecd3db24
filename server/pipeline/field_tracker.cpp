#include "server/pipeline/field_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/pipeline/reckoning.hpp"

namespace wayfuse {
namespace {

constexpr double kLongPauseS = 5.0;          // without reports for longer, the walker may be anywhere within a stroll [SAFETY C15]
constexpr double kStrollMps = 1.0;
constexpr double kMostSpread_m = 50.0;
constexpr double kDoubtMemory = 0.6;         // of the last scans' fit and disagreement in the running mean
constexpr double kSettled_m = 8.0;             // a cloud smaller than this knows where a scan was heard
constexpr double kClimbing_mps = 0.15;        // steeper is a stair, a ramp or a lift, not a swinging arm
constexpr double kClimbed_m = 2.0;            // by the barometer: another floor is near at hand
constexpr double kClimbMemoryS = 30.0;
constexpr double kFloorMemoryClimbing = 0.9;
constexpr double kLeastVote = 1e-9;           // a floor without one can still be told by the next scan
constexpr double kTrustClimbing = 2.5;        // power of the floor votes then
constexpr double kRenewedOnNewFloor = 0.3;
constexpr double kClearSky_m = 15.0;          // sigma of a satellite fix that can tell outdoors from indoors
constexpr double kGnssLastsS = 10.0;          // without another fix the phone may be indoors again
constexpr double kGnssFar = 3.0;              // of the common sigma: a cloud that far off is lost
constexpr int kFixesElsewhere = 2;             // in a row: one satellite fix errs, two that stand apart from the rest do not
constexpr double kGnssMemoryS = 20.0;         // of a fix's error: reflections last as long as the street looks the same
constexpr double kOutside = 2.0;              // of a fix's sigma off the plan
constexpr int kScansAtRest = 3;              // then a phone at rest has heard what there is to hear
constexpr int kFixesAtRest = 3;              // of satellites, likewise
constexpr int kForeignFloors = 3;            // scans in a row that move a phone at rest to another floor: a lift

bool sound(const MotionReport& m) {
  const double values[] = {m.heading.radians(), m.heading_sigma_rad, m.turn_rate_radps, m.step_length_m, m.distance_sigma_m,
                           m.speed_mps.value_or(0.0), m.climb_m.value_or(0.0)};
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value) && std::abs(value) < 1e4; }) &&
         m.interval >= Duration{0} && m.distance_m() >= 0.0;
}

class FieldPipeline final : public TrackerFactory {
 public:
  FieldPipeline(PipelineSpec spec, std::shared_ptr<const FieldTrackerParts> parts) : spec_(std::move(spec)), parts_(std::move(parts)) {}
  std::unique_ptr<Tracker> make_tracker(Random random, const std::optional<KnownStart>& start) const override {
    return std::make_unique<FieldTracker>(parts_, random, start);
  }
  std::unique_ptr<Tracker> take_over(const Tracker& older) const override {
    const auto* tracker = dynamic_cast<const FieldTracker*>(&older.core());
    if (!tracker || tracker->parts().settings != parts_->settings || !same_axes(*tracker->parts().site, *parts_->site)) return nullptr;
    return std::make_unique<FieldTracker>(parts_, *tracker);
  }
  const PipelineSpec& spec() const override { return spec_; }

 private:
  PipelineSpec spec_;
  std::shared_ptr<const FieldTrackerParts> parts_;
};

}  // namespace

std::shared_ptr<const TrackerFactory> make_field_pipeline(const PipelineSpec& spec, std::shared_ptr<const FieldTrackerParts> parts) {
  return std::make_shared<FieldPipeline>(spec, std::move(parts));
}

FieldTracker::FieldTracker(std::shared_ptr<const FieldTrackerParts> parts, Random random, const std::optional<KnownStart>& start)
    : parts_(std::move(parts)), random_(random), locator_(parts_->locator->make()), cloud_(parts_->settings) {
  if (!start) return;
  floor_ = start->place.floor;
  floors_ = {{*floor_, 1.0}};
  cloud_.enter(parts_->walkable.plan(*floor_));
  start_heading_ = start->heading;
  cloud_.start_about(minus(start->place.point, parts_->origin), start->sigma_m, compass(), random_);
}

FieldTracker::FieldTracker(const FieldTracker& other)
    : parts_(other.parts_),
      random_(other.random_),
      locator_(other.locator_->clone()),
      cloud_(other.cloud_),
      second_(other.second_),
      contradicted_(other.contradicted_),
      floors_(other.floors_),
      votes_(other.votes_),
      votes_before_(other.votes_before_),
      floor_(other.floor_),
      odometry_(other.odometry_),
      newest_(other.newest_),
      moved_to_(other.moved_to_),
      newest_reading_(other.newest_reading_),
      weighed_to_(other.weighed_to_),
      start_heading_(other.start_heading_),
      reference_(other.reference_),
      heading_rad_(other.heading_rad_),
      heading_sigma_rad_(other.heading_sigma_rad_),
      speed_mps_(other.speed_mps_),
      at_rest_(other.at_rest_),
      scans_at_rest_(other.scans_at_rest_),
      fixes_at_rest_(other.fixes_at_rest_),
      foreign_floor_(other.foreign_floor_),
      heard_scans_(other.heard_scans_),
      scans_elsewhere_(other.scans_elsewhere_),
      climbed_m_(other.climbed_m_),
      gnss_at_(other.gnss_at_),
      scan_agreed_at_(other.scan_agreed_at_),
      disputed_at_(other.disputed_at_),
      outdoors_(other.outdoors_),
      fixes_outside_(other.fixes_outside_),
      fixes_elsewhere_(other.fixes_elsewhere_),
      mismatch_(other.mismatch_),
      implausible_(other.implausible_),
      watch_(other.watch_),
      from_(other.from_) {}

FieldTracker::FieldTracker(std::shared_ptr<const FieldTrackerParts> parts, const FieldTracker& older) : FieldTracker(older) {
  parts_ = std::move(parts);
  locator_ = parts_->locator->make();
  locator_->inherit(*older.locator_);
  const BuildingPoint moved = minus(older.parts_->origin, parts_->origin);
  if (moved != BuildingPoint{}) cloud_.shift(moved.x_m, moved.y_m);
  second_.drop();
  if (floor_) cloud_.enter(outdoors_ ? nullptr : parts_->walkable.plan(*floor_));
  watch_.begin_anew_with_the_survey();
}

CompassPrior FieldTracker::compass() const {
  if (start_heading_ && reference_) return {wrap_angle_rad(start_heading_->radians() - heading_rad_), false};
  return {0.0, reference_ == HeadingReference::kArbitrary};
}

double FieldTracker::in_frame_rad(const MotionReport& motion) const {
  if (motion.reference == HeadingReference::kArbitrary) return motion.heading.radians();
  Heading heading = motion.heading;
  // Declination is clockwise from true north, a Heading turns counter-clockwise.
  if (motion.reference == HeadingReference::kMagnetic) heading = heading.turned_by(-parts_->site->magnetic_field.declination_rad);
  return parts_->site->georeference ? parts_->site->georeference->to_building(heading).radians() : heading.radians();
}

void FieldTracker::feed(const MotionReport& motion) {
  if (!sound(motion)) return;
  const PhoneTime begin = motion.time - motion.interval;
  if (!moved_to_) moved_to_ = begin;
  const double dt_s = seconds(motion.time - *moved_to_);
  if (dt_s <= 0.0) return;  // no propagation for time that did not pass
  const double interval_s = seconds(motion.interval);
  const double covered_s = std::min(interval_s, dt_s);
  heading_rad_ = in_frame_rad(motion);
  heading_sigma_rad_ = motion.reference == HeadingReference::kArbitrary ? kLostHeadingRad : motion.heading_sigma_rad;
  if (reference_ != motion.reference) {
    reference_ = motion.reference;
    if (cloud_.started()) cloud_.turn_about(compass(), random_);
    start_heading_.reset();
  }
  const double distance_m = motion.distance_m() * (interval_s > 0.0 ? covered_s / interval_s : 1.0);
  const double dx_m = distance_m * std::cos(heading_rad_), dy_m = distance_m * std::sin(heading_rad_);
  odometry_.move(motion.time, dx_m, dy_m);
  moved_to_ = motion.time;
  newest_ = std::max(newest_.value_or(motion.time), motion.time);
  speed_mps_ = distance_m / dt_s;
  at_rest_ = motion.at_rest;
  const bool lifted = std::abs(motion.climb_m.value_or(0.0)) > kClimbing_mps * dt_s;   // a lift carries who stands still
  if ((!at_rest_ && distance_m > 0.0) || lifted) scans_at_rest_ = fixes_at_rest_ = 0;
  from_.steps_since_scan += motion.steps;
  climbed_m_ = climbed_m_ * std::exp(-dt_s / kClimbMemoryS) + motion.climb_m.value_or(0.0);
  if (cloud_.started()) walk(motion, dt_s, dx_m, dy_m);
}

void FieldTracker::walk(const MotionReport& motion, double dt_s, double dx_m, double dy_m) {
  const double pause_s = dt_s - std::min(seconds(motion.interval), dt_s);
  const double distance_m = std::hypot(dx_m, dy_m);
  double sigma_m = motion.at_rest ? 0.0 : parts_->settings.step_sigma_rtm * std::sqrt(distance_m);
  if (pause_s > kLongPauseS) sigma_m = std::hypot(sigma_m, std::min(kStrollMps * pause_s, kMostSpread_m));
  if (seconds(motion.interval) > kLongPauseS) sigma_m = std::hypot(sigma_m, 0.5 * distance_m);  // its path may have bent
  // On stairs nobody knows the stride.
  if (std::abs(motion.climb_m.value_or(0.0)) > kClimbing_mps * dt_s) sigma_m = std::hypot(sigma_m, 0.5 * distance_m);
  cloud_.walk(dx_m, dy_m, sigma_m, motion.at_rest ? 0.0 : dt_s, random_);
  second_.walk(dx_m, dy_m, sigma_m, motion.at_rest ? 0.0 : dt_s, random_);
}

void FieldTracker::feed(const RssScan& scan) {
  newest_ = std::max(newest_.value_or(scan.time), scan.time);
  ++heard_scans_;
  watch_.hear(scan, odometry_.now());
  const auto fix = locator_->locate(scan);
  if (!fix) return;
  const FloorProbability own{fix->place.floor, 1.0};
  const auto votes = locator_->floors().empty() ? std::span(&own, 1) : locator_->floors();
  votes_.assign(votes.begin(), votes.end());
  from_.transmitters_used = locator_->transmitters_known();
  from_.transmitters_unknown = locator_->transmitters_unknown();
  from_.steps_since_scan = 0;
  newest_reading_ = scan.time - locator_->heard_before();
  if (outdoors_) {
    if (seconds(scan.time - *gnss_at_) < kGnssLastsS) return locator_->rest();  // heard through the facade
    outdoors_ = false;
  }
  const bool climbed = believe_floors();
  const BuildingPoint carried = minus(odometry_.now(), odometry_.at(scan.time - locator_->heard_before()));
  const bool lost = cloud_.started() && astray(*fix, carried);
  const bool begun_anew = lost && give_up(*fix, carried);
  if (!cloud_.started()) {
    cloud_.start_from(*locator_, *floor_, carried, compass(), random_);
  } else if (!begun_anew && (informative() || climbed || lost)) {
    const WalkerCloud::Hearing heard = cloud_.weigh(*locator_, *floor_, carried, echo());
    const bool lost_to_another = second_opinion(heard.log_evidence, *fix, carried);
    if (elsewhere(heard.agree) && !lost_to_another) give_up(*fix, carried);
    const bool on_new_floor = climbed && !lost && !lost_to_another;
    // Not while it has a rival: walkers drawn from the scans would speak for the rival's place in the track's name.
    if (!second_.challenges()) cloud_.renew(on_new_floor ? kRenewedOnNewFloor : cloud_.renewed(), *locator_, *floor_, carried, compass(), random_);
    cloud_.settle(random_);
  }
  weighed_to_ = newest_reading_;
  if (!contradicted_ && !lost && locator_->mismatch() < kFits) scan_agreed_at_ = newest_;
  take_stock(scan, carried);
  locator_->rest();
}

/// Correlation of the newest scan's error with the last one's: in one aisle they err alike for a while.
double FieldTracker::echo() const {
  if (!weighed_to_) return 0.0;
  return std::exp(-std::max(0.0, seconds(*newest_reading_ - *weighed_to_)) / parts_->settings.decorrelation_s);
}

// How well the scan fits the survey, and whether it fits the place.
void FieldTracker::take_stock(const RssScan& scan, BuildingPoint carried) {
  mismatch_ = heard_scans_ == 1 ? locator_->mismatch() : kDoubtMemory * mismatch_ + (1.0 - kDoubtMemory) * locator_->mismatch();
  implausible_ = 0;
  int out_of_place = 0;
  if (cloud_.started()) {
    const WalkerCloud::Spread now = cloud_.spread();
    const Place heard_at{minus(now.mean, carried), *floor_};
    implausible_ = locator_->implausible(heard_at.floor, heard_at.point);
    out_of_place = locator_->out_of_place(heard_at.floor, heard_at.point);
    const bool settled = now.covariance.xx_m2 + now.covariance.yy_m2 < kSettled_m * kSettled_m;
    if (settled && scans_at_rest_ <= kScansAtRest) locator_->learn(scan, heard_at);
  }
  watch_.count_strong(out_of_place, *newest_);
}

// A phone at rest hears the same again and again: after a few scans there is nothing to learn.
bool FieldTracker::informative() {
  if (!moved_to_ || !at_rest_) return true;
  return ++scans_at_rest_ <= kScansAtRest;
}

/// True when the floor changed.
bool FieldTracker::believe_floors() {
  const bool climbing = std::abs(climbed_m_) > kClimbed_m;
  const double kept = climbing ? std::min(kFloorMemoryClimbing, parts_->settings.floor_memory) : parts_->settings.floor_memory;
  // A floor the map does not have (any more) has no say.
  std::erase_if(floors_, [&](const FloorProbability& belief) { return std::ranges::find(votes_, belief.floor, &FloorProbability::floor) == votes_.end(); });
  if (floors_.empty()) {
    floors_ = votes_;
  } else {
    if (at_rest_ && moved_to_ && scans_at_rest_ >= kScansAtRest) {
      foreign_floor_ = votes_.front().floor == *floor_ ? 0 : foreign_floor_ + 1;
      if (foreign_floor_ < kForeignFloors) return false;
    }
    double total = 0.0;
    const double repeated = echo();
    for (const FloorProbability& vote : votes_) {
      const auto before = std::ranges::find(votes_before_, vote.floor, &FloorProbability::floor);
      const double said = before == votes_before_.end() ? 1.0 : before->probability;
      const double news = std::pow(std::max(kLeastVote, vote.probability) / std::pow(std::max(kLeastVote, said), repeated), 1.0 / (1.0 + repeated));
      auto belief = std::ranges::find(floors_, vote.floor, &FloorProbability::floor);
      if (belief == floors_.end()) belief = floors_.insert(floors_.end(), {vote.floor, 0.0});
      belief->probability = (kept * belief->probability + (1.0 - kept) / static_cast<double>(votes_.size())) *
                            (climbing ? std::pow(news, kTrustClimbing) : news);
      total += belief->probability;
    }
    for (FloorProbability& belief : floors_) belief.probability = total > 0.0 ? belief.probability / total : 1.0 / static_cast<double>(floors_.size());
  }
  votes_before_ = votes_;
  most_probable_first(floors_);
  foreign_floor_ = 0;
  const FloorOrdinal best = floors_.front().floor;
  const bool climbed = floor_ && *floor_ != best;
  floor_ = best;
  cloud_.enter(outdoors_ ? nullptr : parts_->walkable.plan(best));
  if (climbed) scans_at_rest_ = 0;
  return climbed;
}

void FieldTracker::feed(const GnssFix& fix) {
  if (!parts_->site->georeference || !(std::abs(fix.point.latitude_deg) <= 90.0) || !(std::abs(fix.point.longitude_deg) <= 360.0) ||
      !(fix.sigma_m > 0.0) || !(fix.sigma_m < 1e5)) {
    return;
  }
  BuildingPoint point = minus(parts_->site->georeference->to_building(fix.point), parts_->origin);
  if (!std::isfinite(point.x_m) || !std::isfinite(point.y_m)) return;
  newest_ = std::max(newest_.value_or(fix.time), fix.time);
  point = plus(point, minus(odometry_.now(), odometry_.at(fix.time)));
  from_.gnss = true;
  if (!floor_) {
    floor_ = FloorOrdinal{0};
    floors_ = {{*floor_, 1.0}};
    cloud_.enter(parts_->walkable.plan(*floor_));
  }
  const double memory = gnss_at_ ? std::exp(-std::max(0.0, seconds(fix.time - *gnss_at_)) / kGnssMemoryS) : 0.0;
  gnss_at_ = std::max(gnss_at_.value_or(fix.time), fix.time);
  const bool far = cloud_.started() && far_off(point, fix.sigma_m);
  fixes_elsewhere_ = far && fix.sigma_m < kClearSky_m ? fixes_elsewhere_ + 1 : 0;
  const bool elsewhere = fixes_elsewhere_ >= kFixesElsewhere;
  const bool held_in = !outdoors_ && scan_agreed_at_ && seconds(fix.time - *scan_agreed_at_) < kGnssLastsS;
  if (far && held_in) {
    if (elsewhere) disputed_at_ = fix.time;
    return;
  }
  const bool left = !held_in && step_out(point, fix.sigma_m);
  if (!cloud_.started() || elsewhere || left) {
    second_.drop();
    return cloud_.start_about(point, fix.sigma_m, compass(), random_);
  }
  if (far && fixes_elsewhere_ > 0) return;  // the next one tells which of them errs
  if (at_rest_ && ++fixes_at_rest_ > kFixesAtRest) return;
  // Fixes err alike for a while: each counts for what it does not repeat of the last, as scans do.
  cloud_.weigh(point, fix.sigma_m * std::sqrt((1.0 + memory) / (1.0 - memory)));
  cloud_.settle(random_);
}

// Out of the building when fixes in a row stand clear of the plan, or the first of all does; in again when one is on it. True when it has
// just been left: the walls held the walkers back meanwhile.
bool FieldTracker::step_out(BuildingPoint point, double sigma_m) {
  const WalkableArea::Plan* plan = parts_->walkable.plan(*floor_);
  const bool tells = plan && sigma_m < kClearSky_m;
  fixes_outside_ = tells && !plan->open_within(point, kOutside * sigma_m) ? fixes_outside_ + 1 : 0;
  const bool was_in = !outdoors_;
  outdoors_ = tells && !plan->open_within(point, 0.0) && (outdoors_ || fixes_outside_ >= (cloud_.started() ? kFixesElsewhere : 1));
  cloud_.enter(outdoors_ ? nullptr : plan);
  return outdoors_ && was_in;
}

// From where no walker is.
bool FieldTracker::far_off(BuildingPoint point, double sigma_m) const {
  const WalkerCloud::Spread now = cloud_.spread();
  const double spread_m = std::sqrt(now.covariance.xx_m2 + now.covariance.yy_m2);
  return distance_m(now.mean, point) > kGnssFar * std::hypot(sigma_m, spread_m);
}

}  // namespace wayfuse
