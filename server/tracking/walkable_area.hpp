#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// Where a walker can be: the floor plans as bitmaps of 0.5 m, a little wider than drawn, because plans and feet are inexact.
///
/// Inside the outline, on a walkable polygon where the floor has any (union, each by the even-odd rule), or near a place
/// where somebody has been. A floor without a plan is open everywhere. Immutable and thread-safe.
class WalkableArea {
 public:
  static constexpr double kCell_m = 0.5;
  static constexpr double kMargin_m = 1.5;

  WalkableArea() = default;
  WalkableArea(std::span<const Floor> floors, std::span<const Place> trodden);

  /// A floor's bitmap, or null where everything is open.
  class Plan {
   public:
    bool open(float x_m, float y_m) const {
      const float column = (x_m - x_m_) * kPerMetre, row = (y_m - y_m_) * kPerMetre;
      if (!(column >= 0.0f && row >= 0.0f && column < static_cast<float>(columns_) && row < static_cast<float>(rows_))) return false;
      return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)] != 0;
    }
    /// Whether anything within `radius_m` of the point is open.
    bool open_within(BuildingPoint point, double radius_m) const;

   private:
    friend class WalkableArea;
    static constexpr float kPerMetre = static_cast<float>(1.0 / kCell_m);
    Plan(const Floor& floor, std::span<const Place> trodden);
    void fill(const Polygon& polygon, std::vector<std::uint8_t>& cells) const;
    void widen();

    FloorOrdinal floor_;
    float x_m_ = 0.0f;
    float y_m_ = 0.0f;
    int columns_ = 0;
    int rows_ = 0;
    std::vector<std::uint8_t> cells_;
  };
  const Plan* plan(FloorOrdinal floor) const;

 private:
  std::vector<Plan> plans_;
};

}  // namespace wayfuse
