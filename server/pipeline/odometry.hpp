#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Dead-reckoned displacement of the last half minute, so that late evidence can be applied where the phone was then.
/// Thread: confined to one session.
class Odometry {
 public:
  void move(PhoneTime time, double dx_m, double dy_m);
  /// Where the phone was at `time`, in dead reckoning's own frame, by linear interpolation. Beyond the newest motion, as fast as in the
  /// last second and for no longer than one: reports come late. The far end is held.
  BuildingPoint at(PhoneTime time) const;
  BuildingPoint now() const { return trail_.empty() ? BuildingPoint{} : trail_.back().point; }

 private:
  struct Mark {
    PhoneTime time;
    BuildingPoint point;
  };
  BuildingPoint ahead(PhoneTime time) const;
  std::span<const Mark> remembered() const { return std::span(trail_).subspan(first_); }

  std::vector<Mark> trail_;        // forgotten marks in front go in bulk, so that nothing is allocated for long
  std::size_t first_ = 0;          // that is remembered
};

}  // namespace wayfuse
