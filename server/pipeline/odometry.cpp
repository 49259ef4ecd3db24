#include "server/pipeline/odometry.hpp"

#include <algorithm>

namespace wayfuse {
namespace {
constexpr Duration kRemembered = std::chrono::seconds(30);
constexpr std::size_t kMostMarks = 1024;
}  // namespace

void Odometry::move(PhoneTime time, double dx_m, double dy_m) {
  const BuildingPoint last = now();
  trail_.push_back({time, {last.x_m + dx_m, last.y_m + dy_m}});
  while (trail_.size() > 2 && (trail_.front().time + kRemembered < time || trail_.size() > kMostMarks)) trail_.pop_front();
}

BuildingPoint Odometry::at(PhoneTime time) const {
  if (trail_.empty()) return {};
  const auto after = std::ranges::lower_bound(trail_, time, {}, &Mark::time);
  if (after == trail_.begin()) return trail_.front().point;
  if (after == trail_.end()) return trail_.back().point;
  const Mark& before = *(after - 1);
  const double share = seconds(time - before.time) / seconds(after->time - before.time);
  return {before.point.x_m + share * (after->point.x_m - before.point.x_m),
          before.point.y_m + share * (after->point.y_m - before.point.y_m)};
}

}  // namespace wayfuse
