#include "wayfuse/sdk/position_now.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse {
namespace {

// Of a circular normal distribution: 68 % and 95 % of it lie within so many sigmas.
constexpr double kRadius68 = 1.5096;
constexpr double kRadius95 = 2.4477;
constexpr Duration kFutureMost = std::chrono::seconds(2);

}  // namespace

void PositionNow::welcomed(const Welcome& welcome) {
  frame_ = welcome.georeference;
  declination_rad_ = welcome.magnetic_field.declination_rad;
}

/// Magnetic azimuth + declination = true azimuth; azimuths run the other way round than headings.
Heading PositionNow::to_local(const MotionReport& report) const {
  Heading heading = report.heading;
  if (report.reference == HeadingReference::kMagnetic) heading = heading.turned_by(-declination_rad_);
  if (report.reference != HeadingReference::kArbitrary && frame_) heading = frame_->to_building(heading);
  return heading.turned_by(turn_rad_);
}

void PositionNow::add(const MotionReport& report, double part) {
  const double distance = report.distance_m() * part;
  heading_ = to_local(report);
  const double covered_s = seconds(report.interval) * part, kept = report.at_rest ? 0.0 : std::exp(-covered_s / settings_.pace_s);
  pace_m_ = kept * pace_m_ + distance;
  pace_s_ = kept * pace_s_ + covered_s;
  reached_ = {reached_.x_m + distance * heading_.cos(), reached_.y_m + distance * heading_.sin()};
  // Without a step for a moment the walker is between two, not standing.
  if (report.at_rest || distance > 0.0 || seconds(report.time - reached_at_) >= settings_.extrapolate_s) reached_at_ = report.time;
  travelled_m_ += distance;
  const double sigma = report.distance_sigma_m > 0 ? report.distance_sigma_m : settings_.step_sigma_m * report.steps;
  along_variance_m2_ += sigma * sigma * part;
  heading_variance_ = std::max(heading_variance_, report.heading_sigma_rad * report.heading_sigma_rad);
}

void PositionNow::moved(const MotionReport& report) {
  if (!reports_.empty() && report.time <= reports_.back().time) return;
  const PhoneTime instant = std::max(report.time, asked_at_);  // a report may come after the dot was drawn
  const BuildingPoint before = fused_ ? shown(instant) : BuildingPoint{};
  reports_.push_back(report);
  if (reports_.size() > settings_.reports_most) reports_.pop_front();
  if (!fused_ || report.time <= fused_->valid_at) return;
  const double interval = seconds(report.interval);
  const double since = seconds(report.time - std::max(reached_at_, fused_->valid_at));
  add(report, interval > 0 ? std::clamp(since / interval, 0.0, 1.0) : 1.0);
  const Reckoned target = reckon(instant);
  offset_ = {before.x_m - target.point.x_m, before.y_m - target.point.y_m};
  offset_at_ = instant;
}

void PositionNow::fused(const FusedPosition& position, PhoneTime now) {
  if (position.valid_at > now + kFutureMost || (fused_ && position.valid_at < fused_->valid_at)) return;
  const bool first = !fused_;
  const BuildingPoint before = first ? BuildingPoint{} : shown(now);
  fused_ = position;
  while (reports_.size() > 1 && reports_[1].time <= position.valid_at) reports_.pop_front();
  // The report in force when the position was valid tells how far the phone's heading was off.
  if (!reports_.empty() && position.heading_sigma_rad < 0.5 &&
      reports_.front().time - reports_.front().interval <= position.valid_at) {
    turn_rad_ = wrap_angle_rad(turn_rad_ + 0.3 * position.heading.minus(to_local(reports_.front())));
  }
  reckon_anew();
  const Reckoned target = reckon(now);
  offset_ = first ? BuildingPoint{} : BuildingPoint{before.x_m - target.point.x_m, before.y_m - target.point.y_m};
  offset_at_ = now;
}

void PositionNow::reckon_anew() {
  reached_ = fused_->place.point;
  reached_at_ = fused_->valid_at;
  travelled_m_ = along_variance_m2_ = heading_variance_ = 0.0;
  pace_s_ = settings_.pace_s;
  pace_m_ = fused_->speed_mps * pace_s_;
  heading_ = fused_->heading;
  for (const MotionReport& report : reports_) {
    if (report.time <= fused_->valid_at) continue;
    const double interval = seconds(report.interval);
    add(report, interval > 0 ? std::clamp(seconds(report.time - reached_at_) / interval, 0.0, 1.0) : 1.0);
  }
}

/// Where the evidence says the walker is, without regard to where the dot was.
PositionNow::Reckoned PositionNow::reckon(PhoneTime now) const {
  const double beyond = std::max(0.0, seconds(now - reached_at_));
  const double carried = std::min(beyond, settings_.extrapolate_s) * speed_mps();
  const double blind = std::max(0.0, beyond - settings_.extrapolate_s) * settings_.idle_sigma_mps;
  const double across = travelled_m_ * std::sqrt(heading_variance_);
  Reckoned result;
  result.point = {reached_.x_m + carried * heading_.cos(), reached_.y_m + carried * heading_.sin()};
  result.variance_m2 = along_variance_m2_ + across * across + 0.25 * carried * carried + blind * blind;
  result.speed_mps = beyond <= settings_.extrapolate_s ? speed_mps() : 0.0;
  return result;
}

double PositionNow::remaining(PhoneTime now) const {
  return std::exp(-std::max(0.0, seconds(now - offset_at_)) / settings_.rejoin_s);
}

BuildingPoint PositionNow::shown(PhoneTime now) const {
  const Reckoned target = reckon(now);
  const double left = remaining(now);
  return {target.point.x_m + left * offset_.x_m, target.point.y_m + left * offset_.y_m};
}

std::optional<LivePosition> PositionNow::at(PhoneTime now) {
  asked_at_ = std::max(asked_at_, now);
  if (!fused_) return std::nullopt;
  const Reckoned target = reckon(now);
  const double left = remaining(now) * std::hypot(offset_.x_m, offset_.y_m);
  LivePosition live;
  live.at = now;
  live.place = {shown(now), fused_->place.floor};
  if (frame_) live.geo = frame_->to_geo(live.place.point);
  live.radius68_m = std::sqrt(fused_->radius68_m * fused_->radius68_m + kRadius68 * kRadius68 * target.variance_m2) + left;
  live.radius95_m = std::sqrt(fused_->radius95_m * fused_->radius95_m + kRadius95 * kRadius95 * target.variance_m2) + left;
  live.heading = heading_;
  live.speed_mps = target.speed_mps;
  live.since_fused = std::max(Duration{0}, now - fused_->valid_at);
  live.integrity = fused_->integrity;
  return live;
}

}  // namespace wayfuse
