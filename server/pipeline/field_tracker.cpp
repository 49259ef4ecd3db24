#include "server/pipeline/field_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/tracking/noise.hpp"

namespace wayfuse {
namespace {

constexpr float kOutsidePenalty = 8.0f;      // log weight: a step through a wall is nearly impossible
constexpr float kJitter_m = 0.15f;           // keeps copies of one particle apart
constexpr float kStrideJitter = 0.004f;
constexpr double kResampleBelow = 0.5;       // of the particles, effective size
constexpr double kLongPauseS = 5.0;          // without reports for longer, the walker may be anywhere within a stroll [SAFETY C15]
constexpr double kStrollMps = 1.0;
constexpr double kMostSpread_m = 50.0;
constexpr double kIdleDriftMps = 0.5;
constexpr double kWithoutMotionMps = 1.3;    // a phone that reports no motion at all may walk as anybody does
constexpr double kStaleScanS = 15.0;
constexpr double kRenewedOnNewFloor = 0.7;
constexpr int kScansAtRest = 3;              // then a phone at rest has heard what there is to hear
constexpr int kForeignFloors = 3;            // scans in a row that move a phone at rest to another floor: a lift
constexpr double kLostHeadingRad = std::numbers::pi / std::numbers::sqrt3;

bool sound(const MotionReport& m) {
  const double values[] = {m.heading.radians(), m.heading_sigma_rad, m.turn_rate_radps, m.step_length_m, m.distance_sigma_m,
                           m.speed_mps.value_or(0.0)};
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value) && std::abs(value) < 1e4; }) &&
         m.interval >= Duration{0} && m.distance_m() >= 0.0;
}

BuildingPoint plus(BuildingPoint a, BuildingPoint b) { return {a.x_m + b.x_m, a.y_m + b.y_m}; }
BuildingPoint minus(BuildingPoint a, BuildingPoint b) { return {a.x_m - b.x_m, a.y_m - b.y_m}; }

class FieldPipeline final : public TrackerFactory {
 public:
  FieldPipeline(PipelineSpec spec, std::shared_ptr<const FieldTrackerParts> parts) : spec_(std::move(spec)), parts_(std::move(parts)) {}
  std::unique_ptr<Tracker> make_tracker(Random random, const std::optional<KnownStart>& start) const override {
    return std::make_unique<FieldTracker>(parts_, random, start);
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

PartDescription field_tracker_description() {
  const FieldTrackerSettings standard;
  return {"filter", "walkers", "walkers with a compass error and stride of their own inside the walkable area, weighed by a field; a whole tracker",
          {{"particles", static_cast<double>(standard.particles), 10, 100000, "walkers; the error falls slowly, the cost grows with it", "-", true},
           {"weight", standard.weight, 0.01, 1, "power of a scan's likelihood: scans of one walk err together; larger trusts scans more", "-"},
           {"outlier", standard.outlier, 0, 1, "likelihood no walker falls below, against the best one's; larger forgives wrong scans", "-"},
           {"renewed", standard.renewed, 0, 0.5, "share drawn anew from each scan; larger finds back sooner and blurs more", "-"},
           {"heading_sigma_rad", standard.heading_sigma_rad, 0, 3.2, "compass error of a fresh walker; larger turns more freely", "-"},
           {"heading_walk_rad_rts", standard.heading_walk_rad_rts, 0, 1, "its random walk per root second", "-"},
           {"stride_sigma", standard.stride_sigma, 0, 0.5, "stride of a fresh walker against the phone's, as a share", "-"},
           {"step_sigma_rtm", standard.step_sigma_rtm, 0, 5, "blur per root metre walked", "-"},
           {"walkable", 1, 0, 1, "0: walls and shops are not looked at", "-", true},
           {"floor_memory", standard.floor_memory, 0, 1, "share of the floor belief a scan keeps; smaller changes floors sooner", "-"}}};
}

FieldTrackerSettings field_tracker_settings(const PartSettings& s) {
  FieldTrackerSettings settings;
  settings.particles = s.count("particles");
  settings.weight = s["weight"];
  settings.outlier = s["outlier"];
  settings.renewed = s["renewed"];
  settings.heading_sigma_rad = s["heading_sigma_rad"];
  settings.heading_walk_rad_rts = s["heading_walk_rad_rts"];
  settings.stride_sigma = s["stride_sigma"];
  settings.step_sigma_rtm = s["step_sigma_rtm"];
  settings.walkable = s.on("walkable");
  settings.floor_memory = s["floor_memory"];
  return settings;
}

FieldTracker::FieldTracker(std::shared_ptr<const FieldTrackerParts> parts, Random random, const std::optional<KnownStart>& start)
    : parts_(std::move(parts)),
      random_(random),
      locator_(parts_->locator->make()),
      cloud_(static_cast<std::size_t>(parts_->settings.particles), ParticleCloud::kBias | ParticleCloud::kScale),
      x_then_m_(cloud_.size()),
      y_then_m_(cloud_.size()),
      gained_(cloud_.size()) {
  if (!start) return;
  floor_ = start->place.floor;
  floors_ = {{*floor_, 1.0}};
  plan_ = parts_->walkable.plan(*floor_);
  start_heading_ = start->heading;
  start_about(minus(start->place.point, parts_->origin), start->sigma_m);
}

FieldTracker::FieldTracker(const FieldTracker& other)
    : parts_(other.parts_),
      random_(other.random_),
      locator_(other.locator_->clone()),
      cloud_(other.cloud_),
      x_then_m_(other.cloud_.size()),
      y_then_m_(other.cloud_.size()),
      gained_(other.cloud_.size()),
      floors_(other.floors_),
      floor_(other.floor_),
      plan_(other.plan_),
      odometry_(other.odometry_),
      started_(other.started_),
      newest_(other.newest_),
      moved_to_(other.moved_to_),
      newest_reading_(other.newest_reading_),
      start_heading_(other.start_heading_),
      reference_(other.reference_),
      heading_rad_(other.heading_rad_),
      heading_sigma_rad_(other.heading_sigma_rad_),
      speed_mps_(other.speed_mps_),
      since_jitter_s_(other.since_jitter_s_),
      at_rest_(other.at_rest_),
      scans_at_rest_(other.scans_at_rest_),
      foreign_floor_(other.foreign_floor_),
      heard_scans_(other.heard_scans_),
      from_(other.from_) {}

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
    if (started_) scatter_columns(0, cloud_.size(), {});
  }
  const double distance_m = motion.distance_m() * (interval_s > 0.0 ? covered_s / interval_s : 1.0);
  const double dx_m = distance_m * std::cos(heading_rad_), dy_m = distance_m * std::sin(heading_rad_);
  odometry_.move(motion.time, dx_m, dy_m);
  moved_to_ = motion.time;
  newest_ = std::max(newest_.value_or(motion.time), motion.time);
  speed_mps_ = distance_m / dt_s;
  at_rest_ = motion.at_rest;
  if (!at_rest_ && distance_m > 0.0) scans_at_rest_ = 0;
  from_.steps_since_scan += motion.steps;
  if (started_) walk(motion, dt_s, dx_m, dy_m);
}

void FieldTracker::walk(const MotionReport& motion, double dt_s, double dx_m, double dy_m) {
  const double pause_s = dt_s - std::min(seconds(motion.interval), dt_s);
  const double distance_m = std::hypot(dx_m, dy_m);
  double sigma_m = motion.at_rest ? 0.0 : parts_->settings.step_sigma_rtm * std::sqrt(distance_m);
  if (pause_s > kLongPauseS) sigma_m = std::hypot(sigma_m, std::min(kStrollMps * pause_s, kMostSpread_m));
  if (seconds(motion.interval) > kLongPauseS) sigma_m = std::hypot(sigma_m, 0.5 * distance_m);  // its path may have bent
  since_jitter_s_ += motion.at_rest ? 0.0 : dt_s;
  if (sigma_m == 0.0) return;
  const Noise noise(random_);
  const auto dx = static_cast<float>(dx_m), dy = static_cast<float>(dy_m), sigma = static_cast<float>(sigma_m);
  const auto x = cloud_.x_m(), y = cloud_.y_m(), bias = cloud_.heading_bias_rad(), scale = cloud_.stride_scale();
  const auto weight = cloud_.log_weight();
  for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
    const float c = scale[i] * std::cos(bias[i]), s = scale[i] * std::sin(bias[i]);
    const Noise::Pair n = noise.normal(i);
    x[i] += c * dx - s * dy + sigma * n.first;
    y[i] += s * dx + c * dy + sigma * n.second;
    if (plan_ && !plan_->open(x[i], y[i])) weight[i] -= kOutsidePenalty;
  }
  settle();
}

// Normalised weights, renewed when too few particles carry them. A cloud wholly off the map starts over from equal weights.
void FieldTracker::settle() {
  cloud_.normalise();
  if (cloud_.effective_size() < kResampleBelow * static_cast<double>(cloud_.size())) resample();
}

void FieldTracker::resample() {
  const auto weight = cloud_.log_weight();
  const auto size = static_cast<double>(cloud_.size());
  const double offset = random_.uniform() / size;
  const auto ancestors = cloud_.ancestors();
  double cumulated = std::exp(static_cast<double>(weight[0]));
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
    const double target = offset + static_cast<double>(i) / size;
    while (cumulated < target && at + 1 < cloud_.size()) cumulated += std::exp(static_cast<double>(weight[++at]));
    ancestors[i] = at;
  }
  cloud_.take_ancestors();
  if (since_jitter_s_ == 0.0) return;  // at rest copies may lie on one another: they say where the phone is, not where it goes
  const auto bias_sigma = static_cast<float>(parts_->settings.heading_walk_rad_rts * std::sqrt(since_jitter_s_));
  since_jitter_s_ = 0.0;
  const Noise place(random_), column(random_);
  const auto x = cloud_.x_m(), y = cloud_.y_m(), bias = cloud_.heading_bias_rad(), scale = cloud_.stride_scale();
  for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
    const Noise::Pair p = place.normal(i), q = column.normal(i);
    const float moved_x = x[i] + kJitter_m * p.first, moved_y = y[i] + kJitter_m * p.second;
    if (open(moved_x, moved_y)) x[i] = moved_x, y[i] = moved_y;
    bias[i] += bias_sigma * q.first;
    scale[i] += kStrideJitter * q.second;
  }
}

// Compass error and stride of fresh particles; then each is carried on as it would have walked.
void FieldTracker::scatter_columns(std::size_t begin, std::size_t end, BuildingPoint carried) {
  const FieldTrackerSettings& settings = parts_->settings;
  const bool lost = reference_ == HeadingReference::kArbitrary && !start_heading_;
  const double known = start_heading_ && reference_ ? start_heading_->radians() - heading_rad_ : 0.0;
  const auto sigma = static_cast<float>(settings.heading_sigma_rad);
  const auto dx = static_cast<float>(carried.x_m), dy = static_cast<float>(carried.y_m);
  const Noise columns(random_), directions(random_);
  const auto x = cloud_.x_m(), y = cloud_.y_m(), bias = cloud_.heading_bias_rad(), scale = cloud_.stride_scale();
  for (std::size_t i = begin; i < end; ++i) {
    const auto number = static_cast<std::uint32_t>(i);
    const Noise::Pair n = columns.normal(number);
    bias[i] = lost ? 2.0f * std::numbers::pi_v<float> * directions.uniform(number).second : static_cast<float>(known) + sigma * n.first;
    scale[i] = std::max(0.5f, 1.0f + static_cast<float>(settings.stride_sigma) * n.second);
    const float c = scale[i] * std::cos(bias[i]), s = scale[i] * std::sin(bias[i]);
    x[i] += c * dx - s * dy;
    y[i] += s * dx + c * dy;
  }
}

void FieldTracker::start_about(BuildingPoint point, double sigma_m) {
  const Noise noise(random_);
  for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
    const Noise::Pair n = noise.normal(i);
    cloud_.x_m()[i] = static_cast<float>(point.x_m + sigma_m * static_cast<double>(n.first));
    cloud_.y_m()[i] = static_cast<float>(point.y_m + sigma_m * static_cast<double>(n.second));
  }
  std::ranges::fill(cloud_.log_weight(), -std::log(static_cast<float>(cloud_.size())));
  scatter_columns(0, cloud_.size(), {});
  started_ = true;
}

void FieldTracker::start_from_scan(BuildingPoint carried) {
  if (!locator_->draw(*floor_, random_, cloud_.x_m(), cloud_.y_m())) return;
  std::ranges::fill(cloud_.log_weight(), -std::log(static_cast<float>(cloud_.size())));
  scatter_columns(0, cloud_.size(), carried);
  started_ = true;
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    if (!open(cloud_.x_m()[i], cloud_.y_m()[i])) cloud_.log_weight()[i] -= kOutsidePenalty;
  }
  since_jitter_s_ = 1.0;
  settle();
}

void FieldTracker::feed(const RssScan& scan) {
  newest_ = std::max(newest_.value_or(scan.time), scan.time);
  ++heard_scans_;
  const auto fix = locator_->locate(scan);
  if (!fix) return;
  from_.transmitters_used = locator_->transmitters_known();
  from_.transmitters_unknown = locator_->transmitters_unknown();
  from_.steps_since_scan = 0;
  newest_reading_ = scan.time - locator_->heard_before();
  const bool climbed = believe_floors();
  const BuildingPoint carried = minus(odometry_.now(), odometry_.at(scan.time - locator_->heard_before()));
  if (!started_) {
    start_from_scan(carried);
  } else if (informative() || climbed) {
    if (climbed) renew(kRenewedOnNewFloor, carried);
    weigh(carried);
    renew(parts_->settings.renewed, carried);
    settle();
  }
  locator_->rest();
}

// A phone at rest hears the same again and again: after a few scans there is nothing to learn.
bool FieldTracker::informative() {
  if (!moved_to_ || !at_rest_) return true;
  return ++scans_at_rest_ <= kScansAtRest;
}

/// True when the floor changed.
bool FieldTracker::believe_floors() {
  const auto votes = locator_->floors();
  const double kept = parts_->settings.floor_memory;
  if (floors_.empty()) {
    floors_.assign(votes.begin(), votes.end());
  } else {
    if (at_rest_ && moved_to_ && scans_at_rest_ >= kScansAtRest) {
      foreign_floor_ = votes.front().floor == *floor_ ? 0 : foreign_floor_ + 1;
      if (foreign_floor_ < kForeignFloors) return false;
    }
    double total = 0.0;
    for (const FloorProbability& vote : votes) {
      auto belief = std::ranges::find(floors_, vote.floor, &FloorProbability::floor);
      if (belief == floors_.end()) belief = floors_.insert(floors_.end(), {vote.floor, 0.0});
      belief->probability = (kept * belief->probability + (1.0 - kept) / static_cast<double>(votes.size())) * vote.probability;
      total += belief->probability;
    }
    for (FloorProbability& belief : floors_) belief.probability = total > 0.0 ? belief.probability / total : 1.0 / static_cast<double>(floors_.size());
  }
  std::ranges::stable_sort(floors_, std::ranges::greater{}, &FloorProbability::probability);
  foreign_floor_ = 0;
  const FloorOrdinal best = floors_.front().floor;
  const bool climbed = floor_ && *floor_ != best;
  floor_ = best;
  plan_ = parts_->walkable.plan(best);
  if (climbed) scans_at_rest_ = 0;
  return climbed;
}

void FieldTracker::weigh(BuildingPoint carried) {
  if (!moved_to_ && newest_reading_) since_jitter_s_ = 1.0;
  const auto dx = static_cast<float>(carried.x_m), dy = static_cast<float>(carried.y_m);
  const auto x = cloud_.x_m(), y = cloud_.y_m(), bias = cloud_.heading_bias_rad(), scale = cloud_.stride_scale();
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const float c = scale[i] * std::cos(bias[i]), s = scale[i] * std::sin(bias[i]);
    x_then_m_[i] = x[i] - (c * dx - s * dy);
    y_then_m_[i] = y[i] - (s * dx + c * dy);
  }
  std::ranges::fill(gained_, 0.0f);
  locator_->add_log_likelihood(x_then_m_, y_then_m_, *floor_, gained_);
  float best = -INFINITY;
  for (const float each : gained_) best = std::isfinite(each) ? std::max(best, each) : best;
  if (!std::isfinite(best)) return;
  const auto weight = static_cast<float>(parts_->settings.weight), outlier = static_cast<float>(parts_->settings.outlier);
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    cloud_.log_weight()[i] += weight * std::log(std::exp(gained_[i] - best) + outlier);
  }
  cloud_.normalise();
}

// Some particles begin again where the scan says. They weigh as much as an average one.
void FieldTracker::renew(double share, BuildingPoint carried) {
  const auto count = static_cast<std::size_t>(share * static_cast<double>(cloud_.size()));
  if (count == 0) return;
  const std::size_t begin = random_.below(cloud_.size() - count + 1);
  if (!locator_->draw(*floor_, random_, cloud_.x_m().subspan(begin, count), cloud_.y_m().subspan(begin, count))) return;
  scatter_columns(begin, begin + count, carried);
  for (std::size_t i = begin; i < begin + count; ++i) {
    cloud_.log_weight()[i] = -std::log(static_cast<float>(cloud_.size()));
    if (!open(cloud_.x_m()[i], cloud_.y_m()[i])) cloud_.log_weight()[i] -= kOutsidePenalty;
  }
}

void FieldTracker::feed(const GnssFix& fix) {
  if (!parts_->site->georeference || !std::isfinite(fix.point.latitude_deg) || !std::isfinite(fix.point.longitude_deg) ||
      !(fix.sigma_m > 0.0) || !(fix.sigma_m < 1e5)) {
    return;
  }
  BuildingPoint point = minus(parts_->site->georeference->to_building(fix.point), parts_->origin);
  if (!std::isfinite(point.x_m) || !std::isfinite(point.y_m)) return;
  newest_ = std::max(newest_.value_or(fix.time), fix.time);
  point = plus(point, minus(odometry_.now(), odometry_.at(fix.time)));
  from_.gnss = true;
  if (!started_) {
    if (!floor_) floors_ = {{FloorOrdinal{0}, 1.0}}, floor_ = FloorOrdinal{0}, plan_ = parts_->walkable.plan(*floor_);
    return start_about(point, fix.sigma_m);
  }
  const auto weight = cloud_.log_weight();
  const auto precision = static_cast<float>(1.0 / (fix.sigma_m * fix.sigma_m));
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const float dx = cloud_.x_m()[i] - static_cast<float>(point.x_m), dy = cloud_.y_m()[i] - static_cast<float>(point.y_m);
    weight[i] -= 0.5f * precision * (dx * dx + dy * dy);
  }
  settle();
}

FieldTracker::Spread FieldTracker::spread() const {
  const auto x = cloud_.x_m(), y = cloud_.y_m(), weight = cloud_.log_weight();
  double sum = 0.0, sx = 0.0, sy = 0.0;
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const double w = std::exp(static_cast<double>(weight[i]));
    sum += w, sx += w * static_cast<double>(x[i]), sy += w * static_cast<double>(y[i]);
  }
  Spread result{sx / sum, sy / sum, {}};
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const double w = std::exp(static_cast<double>(weight[i])) / sum;
    const double dx = static_cast<double>(x[i]) - result.x_m, dy = static_cast<double>(y[i]) - result.y_m;
    result.covariance.xx_m2 += w * dx * dx, result.covariance.xy_m2 += w * dx * dy, result.covariance.yy_m2 += w * dy * dy;
  }
  return result;
}

std::optional<FusedPosition> FieldTracker::position(PhoneTime at) const {
  if (!started_ || !floor_) return std::nullopt;
  const Spread now = spread();
  if (!std::isfinite(now.x_m) || !std::isfinite(now.y_m)) return std::nullopt;
  const double idle_s = newest_ ? std::max(0.0, seconds(at - *newest_)) : 0.0;
  const double drift_m = at_rest_ || idle_s < 1.0 ? 0.0 : (moved_to_ ? kIdleDriftMps : kWithoutMotionMps) * idle_s;
  const double radius_m = std::sqrt(now.covariance.xx_m2 + now.covariance.yy_m2);
  FusedPosition position;
  position.valid_at = at;
  position.building = parts_->site->building;
  position.place = {plus({now.x_m, now.y_m}, parts_->origin), *floor_};
  if (parts_->site->georeference) position.geo = parts_->site->georeference->to_geo(position.place.point);
  position.floors = floors_;
  position.covariance = {now.covariance.xx_m2 + drift_m * drift_m, now.covariance.xy_m2, now.covariance.yy_m2 + drift_m * drift_m};
  position.radius68_m = std::hypot(0.75 * std::hypot(radius_m, 4.0), drift_m);
  position.radius95_m = std::max(position.radius68_m, std::hypot(1.0 * std::hypot(radius_m, 8.0), 2.0 * drift_m));
  position.heading = Heading::from_radians(heading_rad_);
  position.heading_sigma_rad = moved_to_ ? std::hypot(heading_sigma_rad_, parts_->settings.heading_sigma_rad) : kLostHeadingRad;
  position.speed_mps = speed_mps_;
  position.radio_map_version = parts_->site->radio_map_version;
  position.from = from_;
  position.from.scan_age = newest_reading_ ? std::max(Duration{0}, at - *newest_reading_) : Duration{0};
  const bool stale = !newest_reading_ || seconds(at - *newest_reading_) > kStaleScanS;
  const bool foreign = from_.transmitters_used < 3 || from_.transmitters_unknown > 3 * from_.transmitters_used;
  position.integrity = stale || foreign ? Integrity::kDegraded : Integrity::kOk;
  return position;
}

Fault FieldTracker::why_no_fix() const {
  if (parts_->empty_map) return {FaultCode::kEmptyRadioMap, "", "the building has no fingerprints yet"};
  if (heard_scans_ == 0) return {FaultCode::kNotFound, "", "no fresh scan heard yet"};
  return {FaultCode::kNoKnownAccessPoint, "", "no access point of the newest scan is on the map"};
}

}  // namespace wayfuse
