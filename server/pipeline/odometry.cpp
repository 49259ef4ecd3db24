#include "server/pipeline/odometry.hpp"

#include <algorithm>

namespace wayfuse {
namespace {
constexpr Duration kRemembered = std::chrono::seconds(30);
constexpr std::size_t kMostMarks = 1024;
constexpr Duration kAhead = std::chrono::seconds(1);
}  // namespace

void Odometry::move(PhoneTime time, double dx_m, double dy_m) {
  const BuildingPoint last = now();
  trail_.push_back({time, {last.x_m + dx_m, last.y_m + dy_m}});
  while (trail_.size() - first_ > 2 && (trail_[first_].time + kRemembered < time || trail_.size() - first_ > kMostMarks)) ++first_;
  if (first_ <= trail_.size() / 2) return;
  trail_.erase(trail_.begin(), trail_.begin() + static_cast<std::ptrdiff_t>(first_));
  first_ = 0;
}

BuildingPoint Odometry::at(PhoneTime time) const {
  const auto trail = remembered();
  if (trail.empty()) return {};
  const auto after = std::ranges::lower_bound(trail, time, {}, &Mark::time);
  if (after == trail.begin()) return trail.front().point;
  if (after == trail.end()) return ahead(time);
  const Mark& before = *(after - 1);
  const double share = seconds(time - before.time) / seconds(after->time - before.time);
  return {before.point.x_m + share * (after->point.x_m - before.point.x_m),
          before.point.y_m + share * (after->point.y_m - before.point.y_m)};
}

BuildingPoint Odometry::ahead(PhoneTime time) const {
  const Mark& newest = trail_.back();
  const BuildingPoint before = at(newest.time - kAhead);
  const double share = seconds(std::min(time - newest.time, kAhead)) / seconds(kAhead);
  return {newest.point.x_m + share * (newest.point.x_m - before.x_m), newest.point.y_m + share * (newest.point.y_m - before.y_m)};
}

}  // namespace wayfuse
