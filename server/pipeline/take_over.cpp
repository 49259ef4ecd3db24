#include <algorithm>
#include <cmath>

#include "server/pipeline/tracker.hpp"

namespace wayfuse {
namespace {

constexpr double kLeastStart_m = 0.5;
constexpr double kSameDeclinationRad = 0.02;  // where the operator states none it follows the survey's year
const double kRadius68 = std::sqrt(-2.0 * std::log(1.0 - 0.68));  // in sigmas of a round Gaussian

}  // namespace

bool same_axes(const Site& a, const Site& b) {
  const double turned_rad = wrap_angle_rad(a.magnetic_field.declination_rad - b.magnetic_field.declination_rad);
  return a.building == b.building && a.georeference == b.georeference && std::abs(turned_rad) < kSameDeclinationRad;
}

std::unique_ptr<Tracker> go_on(const TrackerFactory& newer, const Tracker& older, PhoneTime at, Random random) {
  if (auto taken = newer.take_over(older)) return taken;
  const auto position = older.position(at);
  if (!position) return newer.make_tracker(random);
  return newer.make_tracker(random, KnownStart{position->place, std::max(kLeastStart_m, position->radius68_m / kRadius68), {}});
}

}  // namespace wayfuse
