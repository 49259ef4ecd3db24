#include "server/pipeline/fusion_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "server/pipeline/field_measurement.hpp"
#include "server/pipeline/reckoning.hpp"
#include "server/tracking/fix_measurement.hpp"
#include "server/tracking/range_measurement.hpp"
#include "server/tracking/velocity_measurements.hpp"

namespace wayfuse {
namespace {

constexpr double kPauseS = 5.0;          // without reports for longer, the walker may be anywhere within a stroll [SAFETY C15]
constexpr double kStrollMps = 1.0;
constexpr double kMostSpreadM = 50.0;
constexpr double kLeastSpeedSigmaMps = 0.1;
constexpr double kLeastHeadingSigmaRad = 0.05;
constexpr double kVagueHeadingRad = 0.7;
constexpr double kWidest_m = 10e3;        // a belief as wide says nothing

double length_m(BuildingPoint a) { return std::hypot(a.x_m, a.y_m); }
double angle_rad(BuildingPoint a) { return std::atan2(a.y_m, a.x_m); }

bool sound(const MotionReport& m) {
  const double values[] = {m.heading.radians(), m.heading_sigma_rad, m.turn_rate_radps, m.step_length_m, m.distance_sigma_m,
                           m.speed_mps.value_or(0.0)};
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value) && std::abs(value) < 1e4; }) &&
         m.interval >= Duration{0} && m.distance_m() >= 0.0;
}

bool finite(const State& s) {
  return std::isfinite(s.x_m) && std::isfinite(s.y_m) && std::isfinite(s.vx_mps) && std::isfinite(s.vy_mps);
}

}  // namespace

FusionTracker::FusionTracker(std::shared_ptr<const PipelineParts> parts, Random random, const std::optional<KnownStart>& start)
    : parts_(std::move(parts)),
      random_(random),
      locator_(parts_->locator ? parts_->locator->make() : nullptr),
      filter_(parts_->make_filter()),
      gate_(parts_->readings),
      floor_(parts_->floor, parts_->map->floors()),
      heading_(parts_->heading) {
  if (!start) return;
  start_at(minus(start->place.point, parts_->origin), start->sigma_m);
  floor_.set(start->place.floor);
  start_heading_ = start->heading;
}

FusionTracker::FusionTracker(const FusionTracker& other)
    : parts_(other.parts_),
      random_(other.random_),
      locator_(other.locator_ ? other.locator_->clone() : nullptr),
      filter_(other.filter_->clone()),
      gate_(other.gate_),
      floor_(other.floor_),
      heading_(other.heading_),
      odometry_(other.odometry_),
      kept_(other.kept_),
      newest_(other.newest_),
      moved_to_(other.moved_to_),
      filtered_to_(other.filtered_to_),
      newest_reading_(other.newest_reading_),
      reported_heading_rad_(other.reported_heading_rad_),
      reference_(other.reference_),
      start_heading_(other.start_heading_),
      anchor_(other.anchor_),
      speed_mps_(other.speed_mps_),
      at_rest_(other.at_rest_),
      misses_(other.misses_),
      heard_scans_(other.heard_scans_),
      restarted_(other.restarted_),
      first_gnss_(other.first_gnss_),
      correction_inputs_(other.correction_inputs_),
      correction_(other.correction_),
      from_(other.from_) {}

FusionTracker::FusionTracker(std::shared_ptr<const PipelineParts> parts, const FusionTracker& older) : FusionTracker(older) {
  parts_ = std::move(parts);
  if (locator_) {
    locator_ = parts_->locator->make();
    locator_->inherit(*older.locator_);
  }
  if (!parts_->corrector) correction_ = {};
  const BuildingPoint moved = minus(older.parts_->origin, parts_->origin);
  if (moved == BuildingPoint{}) return;
  filter_->shift(moved.x_m, moved.y_m);
  if (anchor_) anchor_->track = plus(anchor_->track, moved);
}

double FusionTracker::in_frame_rad(const MotionReport& motion) const {
  Heading heading = motion.heading;
  if (motion.reference == HeadingReference::kArbitrary) return heading.radians();
  // Declination is clockwise from true north, a Heading turns counter-clockwise.
  if (motion.reference == HeadingReference::kMagnetic) heading = heading.turned_by(-parts_->site->magnetic_field.declination_rad);
  return parts_->site->georeference ? parts_->site->georeference->to_building(heading).radians() : heading.radians();
}

void FusionTracker::turn(const MotionReport& motion, double dt_s) {
  const double reported_rad = in_frame_rad(motion);
  const bool arbitrary = motion.reference == HeadingReference::kArbitrary;
  if (!heading_.started() || reference_ != motion.reference) {
    if (start_heading_) {
      heading_.start(start_heading_->radians(), std::max(motion.heading_sigma_rad, 0.05));
      start_heading_.reset();
    } else if (!heading_.started() || !arbitrary) {  // onto an arbitrary origin an older absolute heading is carried over
      heading_.start(reported_rad, arbitrary ? kLostHeadingRad : std::max(motion.heading_sigma_rad, 0.02));
    }
  } else if (parts_->track_heading || arbitrary) {
    heading_.predict(wrap_angle_rad(reported_rad - *reported_heading_rad_), dt_s);
  } else {
    heading_.start(reported_rad, motion.heading_sigma_rad);
  }
  reference_ = motion.reference;
  reported_heading_rad_ = reported_rad;
}

void FusionTracker::feed(const MotionReport& motion) {
  if (!sound(motion)) return;
  const PhoneTime begin = motion.time - motion.interval;
  gate_.begin(begin);
  if (!moved_to_) moved_to_ = begin;
  const double dt_s = seconds(motion.time - *moved_to_);
  if (dt_s <= 0.0) return;  // no propagation for time that did not pass
  const double interval_s = seconds(motion.interval);
  const double covered_s = std::min(interval_s, dt_s);
  const double pause_s = dt_s - covered_s;
  turn(motion, dt_s);

  Motion moved{dt_s, heading_.heading_rad(), std::sqrt(heading_.variance_rad2()), 0.0, motion.distance_sigma_m, 0.0, motion.steps,
               motion.at_rest};
  moved.distance_m = motion.distance_m() * (interval_s > 0.0 ? covered_s / interval_s : 1.0);
  if (pause_s > kPauseS) moved.spread_m = std::min(kStrollMps * pause_s, kMostSpreadM);
  if (covered_s > kPauseS) moved.spread_m = std::hypot(moved.spread_m, 0.5 * moved.distance_m);  // its path may have bent

  // Nobody knows where to: the mean of all directions, nearly nowhere. The reckoned path keeps its length, to be aligned by.
  const double known = moved.heading_sigma_rad > kVagueHeadingRad ? std::exp(-0.5 * heading_.variance_rad2()) : 1.0;

  odometry_.move(motion.time, moved.distance_m * std::cos(moved.heading_rad), moved.distance_m * std::sin(moved.heading_rad));
  moved_to_ = motion.time;
  newest_ = std::max(newest_.value_or(motion.time), motion.time);
  speed_mps_ = moved.distance_m / dt_s;
  at_rest_ = motion.at_rest;
  from_.steps_since_scan += motion.steps;
  if (!filter_->started()) return;
  if (parts_->motion->uses_distance()) {
    moved.distance_sigma_m = std::hypot(moved.distance_sigma_m, (1.0 - known) * moved.distance_m);
    moved.distance_m *= known;
    filter_->predict(moved, random_);
    filtered_to_ = motion.time;
  } else {
    advance(motion.time);
    if (filter_->started()) measure_velocity(motion, moved);
  }
  guard_against_nonsense();
}

// Moves a filter that lives on time alone; one that is moved by reports waits for them.
void FusionTracker::advance(PhoneTime time) {
  if (!filter_->started() || parts_->motion->uses_distance()) return;
  if (filtered_to_ && time > *filtered_to_) filter_->predict(Motion{.dt_s = seconds(time - *filtered_to_)}, random_);
  if (!filtered_to_ || time > *filtered_to_) filtered_to_ = time;
  guard_against_nonsense();
}

void FusionTracker::feed(const RssScan& scan) {
  newest_ = std::max(newest_.value_or(scan.time), scan.time);
  const auto fresh = gate_.take(scan, kept_);
  if (!locator_ || !fresh) return;
  ++heard_scans_;
  auto fix = locator_->locate(kept_);
  const BuildingPoint carried = minus(odometry_.now(), odometry_.at(fresh->heard));
  if (!fix || !std::isfinite(fix->place.point.x_m) || !std::isfinite(fix->place.point.y_m)) return teach(carried);
  from_.transmitters_used = locator_->transmitters_known();
  from_.transmitters_unknown = locator_->transmitters_unknown();
  from_.steps_since_scan = 0;
  newest_reading_ = fresh->newest;
  const FloorProbability own{fix->place.floor, 1.0};  // of a locator that does not vote
  floor_.update(locator_->floors().empty() ? std::span(&own, 1) : locator_->floors());
  apply(*fix, carried);
}

void FusionTracker::measure_velocity(const MotionReport& motion, const Motion& moved) {
  const double speed_mps = moved.distance_m / moved.dt_s, stated_mps = moved.distance_sigma_m / moved.dt_s;
  const double sigma_mps = parts_->speed.sigma > 0.0 ? parts_->speed.sigma : std::max(stated_mps, kLeastSpeedSigmaMps);
  const double sigma_rad = parts_->azimuth.sigma > 0.0 ? parts_->azimuth.sigma : std::max(moved.heading_sigma_rad, kLeastHeadingSigmaRad);
  const bool directed = parts_->azimuth.on && !motion.at_rest && motion.reference != HeadingReference::kArbitrary;
  if (directed && parts_->resolved) {
    filter_->update(ResolvedVelocityMeasurement(speed_mps, sigma_mps, moved.heading_rad, sigma_rad), random_);
    return;
  }
  if (parts_->speed.on) filter_->update(SpeedMeasurement(speed_mps, sigma_mps), random_);
  if (directed) filter_->update(DirectionMeasurement(moved.heading_rad, sigma_rad), random_);
}

// `carried`: what dead reckoning covered since the readings were heard.
void FusionTracker::apply(const Fix& fix, BuildingPoint carried) {
  if (parts_->measurement == MeasurementKind::kNone) return;
  advance(*newest_);
  if (fix.place.floor != floor_.floor()) return;  // a vote that was overruled says nothing about this floor
  const BuildingPoint point = plus(fix.place.point, carried);
  if (!filter_->started() || parts_->measurement == MeasurementKind::kFix) {
    apply_fix(point, parts_->fix.sigma_m > 0.0 ? parts_->fix.sigma_m : parts_->fix.sigma_scale * fix.sigma_m);
  } else if (parts_->measurement == MeasurementKind::kRanges) {
    apply_ranges(carried);
  } else {
    apply_field(carried);
  }
  align_heading();
  teach(carried);
}

// Where the filter says the phone was teaches the locator, also and above all when its own fix was none.
void FusionTracker::teach(BuildingPoint carried) {
  if (parts_->measurement == MeasurementKind::kNone || !filter_->started()) return;
  advance(*newest_);
  if (!filter_->started()) return;
  const State mean = filter_->estimate().mean;
  locator_->learn(kept_, {minus({mean.x_m, mean.y_m}, carried), floor_.floor()});
}

void FusionTracker::apply_fix(BuildingPoint point, double sigma_m) {
  if (!filter_->started()) return start_at(point, sigma_m);
  misses_ = agrees(point, sigma_m, parts_->recovery.gate_sigmas) ? 0 : misses_ + 1;
  if (parts_->recovery.restart && misses_ >= parts_->recovery.misses) {
    restarted_ = newest_;
    return start_at(point, sigma_m);
  }
  correction_inputs_.reset();
  if (parts_->fix.gate_sigmas > 0.0 && !agrees(point, sigma_m, parts_->fix.gate_sigmas)) return;
  const GaussianState before = filter_->estimate();
  if (filter_->update(FixMeasurement(point.x_m, point.y_m, sigma_m), random_)) note_correction(before, point, sigma_m);
  guard_against_nonsense();
}

void FusionTracker::note_correction(const GaussianState& before, BuildingPoint point, double sigma_m) {
  const State after = filter_->estimate().mean;
  const double variance = sigma_m * sigma_m;
  correction_inputs_ = {after.x_m - before.mean.x_m, after.y_m - before.mean.y_m,
                        before.covariance[0] / (before.covariance[0] + variance),
                        before.covariance[5] / (before.covariance[5] + variance),
                        point.x_m - before.mean.x_m, point.y_m - before.mean.y_m};
  if (parts_->corrector) correction_ = {parts_->corrector->x(*correction_inputs_), parts_->corrector->y(*correction_inputs_)};
}

void FusionTracker::apply_ranges(BuildingPoint carried) {
  RangeMeasurement measurement;
  for (const TransmitterRange& range : locator_->ranges()) {
    const BuildingPoint at = plus(range.transmitter, carried);  // the phone moved on: so do the circles
    measurement.add({at.x_m, at.y_m, range.distance_m, parts_->range_sigma_scale * range.sigma_m});
  }
  if (measurement.dimension() > 0) filter_->update(measurement, random_);
  guard_against_nonsense();
}

void FusionTracker::apply_field(BuildingPoint carried) {
  const FieldMeasurement measurement(*locator_, floor_.floor(), carried, parts_->field.weight, parts_->field.outlier, field_scratch_);
  filter_->update(measurement, random_);
  guard_against_nonsense();
}

bool FusionTracker::agrees(BuildingPoint point, double sigma_m, double sigmas) const {
  const GaussianState belief = filter_->estimate();
  const double xx = belief.covariance[0] + sigma_m * sigma_m;
  const double yy = belief.covariance[5] + sigma_m * sigma_m;
  const double xy = belief.covariance[1];
  const double dx = point.x_m - belief.mean.x_m;
  const double dy = point.y_m - belief.mean.y_m;
  const double squared = (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy);
  return squared <= sigmas * sigmas;
}

void FusionTracker::start_at(BuildingPoint point, double sigma_m) {
  filter_->start(isotropic({point.x_m, point.y_m, 0.0, 0.0}, sigma_m, kStrollMps), random_);
  filtered_to_ = newest_;
  anchor_.reset();
  correction_inputs_.reset();
  correction_ = {};
  misses_ = 0;
}

void FusionTracker::align_heading() {
  if (!heading_.started() || !(parts_->track_heading || reference_ == HeadingReference::kArbitrary)) return;
  const State mean = filter_->estimate().mean;
  const BuildingPoint here{mean.x_m, mean.y_m};
  if (anchor_) {
    const BuildingPoint reckoned = minus(odometry_.now(), anchor_->odometry);
    const BuildingPoint track = minus(here, anchor_->track);
    if (length_m(reckoned) < parts_->heading.piece_m) return;
    // The direction of a bent track is compared with the bent path reckoned for it: on a straight one this is phi_PF.
    const double error_rad = wrap_angle_rad(angle_rad(track) - angle_rad(reckoned));
    if (length_m(track) > 0.3 * length_m(reckoned)) heading_.update(heading_.heading_rad() + error_rad, length_m(reckoned));
  }
  anchor_ = Anchor{here, odometry_.now()};
}

void FusionTracker::feed(const GnssFix& fix) {
  // Beyond the poles a finite number may lie, and a metre count that no float holds.
  if (parts_->gnss == GnssUse::kNone || !parts_->site->georeference || !(std::abs(fix.point.latitude_deg) <= 90.0) ||
      !(std::abs(fix.point.longitude_deg) <= 360.0) || !(fix.sigma_m > 0.0) || !(fix.sigma_m < 1e5)) {
    return;
  }
  newest_ = std::max(newest_.value_or(fix.time), fix.time);
  if (!first_gnss_) first_gnss_ = fix.time;
  if (parts_->gnss == GnssUse::kStart && seconds(fix.time - *first_gnss_) > parts_->gnss_start_s) return;
  advance(fix.time);
  if (!floor_.started()) floor_.set(FloorOrdinal{0});
  BuildingPoint point = minus(parts_->site->georeference->to_building(fix.point), parts_->origin);
  if (!std::isfinite(point.x_m) || !std::isfinite(point.y_m)) return;
  point = plus(point, minus(odometry_.now(), odometry_.at(fix.time)));
  from_.gnss = true;
  apply_fix(point, fix.sigma_m);
  align_heading();
}

void FusionTracker::guard_against_nonsense() {
  if (!filter_->started()) return;
  const GaussianState state = filter_->estimate();
  // Nonsense may also cost a Kalman filter its positive variances, or take it, in hours without a fix, beyond what a place may be: there is
  // no going on from that either.
  const bool known = state.covariance[0] >= 0.0 && state.covariance[5] >= 0.0 && state.covariance[0] + state.covariance[5] < kWidest_m * kWidest_m;
  if (finite(state.mean) && known && is_near({state.mean.x_m, state.mean.y_m})) return;
  filter_ = parts_->make_filter();  // begins again with the next fix
  anchor_.reset();
}

}  // namespace wayfuse
