#include "server/tracking/walkable_area.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse {
namespace {
constexpr double kLargest_m = 4000.0;    // a plan beyond this is a mistake in units, and is not drawn
}

WalkableArea::WalkableArea(std::span<const Floor> floors, std::span<const Place> trodden) {
  for (const Floor& floor : floors) {
    const auto drawable = [](const Polygon& polygon) { return !polygon.rings.empty() && polygon.rings.front().size() >= 3; };
    if (drawable(floor.outline) || std::ranges::any_of(floor.walkable, drawable)) {
      Plan plan(floor, trodden);
      if (!plan.cells_.empty()) plans_.push_back(std::move(plan));
    }
  }
}

const WalkableArea::Plan* WalkableArea::plan(FloorOrdinal floor) const {
  const auto found = std::ranges::find(plans_, floor, &Plan::floor_);
  return found == plans_.end() ? nullptr : &*found;
}

bool WalkableArea::Plan::open_within(BuildingPoint point, double radius_m) const {
  const double column = (point.x_m - static_cast<double>(x_m_)) / kCell_m, row = (point.y_m - static_cast<double>(y_m_)) / kCell_m;
  const double reach = std::max(0.75, radius_m / kCell_m);  // the point's own cell at least
  const auto bound = [](double cell, int count) { return static_cast<int>(std::clamp(cell, 0.0, static_cast<double>(count))); };
  for (int r = bound(row - reach, rows_); r < bound(row + reach + 1.0, rows_); ++r) {
    for (int c = bound(column - reach, columns_); c < bound(column + reach + 1.0, columns_); ++c) {
      if (std::hypot(c + 0.5 - column, r + 0.5 - row) > reach) continue;
      if (cells_[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)] != 0) return true;
    }
  }
  return false;
}

WalkableArea::Plan::Plan(const Floor& floor, std::span<const Place> trodden) : floor_(floor.ordinal) {
  double low_x = INFINITY, low_y = INFINITY, high_x = -INFINITY, high_y = -INFINITY;
  const auto include = [&](BuildingPoint p) {
    low_x = std::min(low_x, p.x_m), high_x = std::max(high_x, p.x_m);
    low_y = std::min(low_y, p.y_m), high_y = std::max(high_y, p.y_m);
  };
  const auto include_all = [&](const Polygon& polygon) {
    for (const Ring& ring : polygon.rings) std::ranges::for_each(ring, include);
  };
  include_all(floor.outline);
  std::ranges::for_each(floor.walkable, include_all);
  for (const Place& place : trodden) {
    if (place.floor == floor.ordinal) include(place.point);
  }
  if (!(high_x - low_x < kLargest_m && high_y - low_y < kLargest_m)) return;
  const double border_m = kMargin_m + 2 * kCell_m;
  x_m_ = static_cast<float>(low_x - border_m);
  y_m_ = static_cast<float>(low_y - border_m);
  columns_ = static_cast<int>((high_x - low_x + 2 * border_m) / kCell_m) + 1;
  rows_ = static_cast<int>((high_y - low_y + 2 * border_m) / kCell_m) + 1;
  const auto size = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  std::vector<std::uint8_t> inside(size, floor.outline.rings.empty() ? 1 : 0);
  fill(floor.outline, inside);
  cells_.assign(size, floor.walkable.empty() ? 1 : 0);
  for (const Polygon& polygon : floor.walkable) fill(polygon, cells_);
  for (std::size_t i = 0; i < size; ++i) cells_[i] = cells_[i] && inside[i];
  for (const Place& place : trodden) {
    if (place.floor != floor.ordinal) continue;
    const auto column = static_cast<std::size_t>((place.point.x_m - static_cast<double>(x_m_)) / kCell_m);
    const auto row = static_cast<std::size_t>((place.point.y_m - static_cast<double>(y_m_)) / kCell_m);
    cells_[row * static_cast<std::size_t>(columns_) + column] = 1;
  }
  widen();
}

// Even-odd by scan lines through the middles of the cells.
void WalkableArea::Plan::fill(const Polygon& polygon, std::vector<std::uint8_t>& cells) const {
  std::vector<double> crossings;
  for (int row = 0; row < rows_; ++row) {
    const double y_m = static_cast<double>(y_m_) + (row + 0.5) * kCell_m;
    crossings.clear();
    for (const Ring& ring : polygon.rings) {
      for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
        if ((ring[i].y_m > y_m) == (ring[j].y_m > y_m)) continue;
        crossings.push_back(ring[i].x_m + (y_m - ring[i].y_m) / (ring[j].y_m - ring[i].y_m) * (ring[j].x_m - ring[i].x_m));
      }
    }
    std::ranges::sort(crossings);
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
      const auto column_of = [&](double x_m) { return static_cast<int>(std::ceil((x_m - static_cast<double>(x_m_)) / kCell_m - 0.5)); };
      for (int column = std::max(0, column_of(crossings[k])); column < std::min(columns_, column_of(crossings[k + 1])); ++column) {
        cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)] = 1;
      }
    }
  }
}

void WalkableArea::Plan::widen() {
  const int reach = static_cast<int>(kMargin_m / kCell_m);
  std::vector<std::uint8_t> wide = cells_;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      if (!cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)]) continue;
      for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          const int r = row + dy, c = column + dx;
          if (dx * dx + dy * dy > reach * reach || r < 0 || c < 0 || r >= rows_ || c >= columns_) continue;
          wide[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)] = 1;
        }
      }
    }
  }
  cells_ = std::move(wide);
}

}  // namespace wayfuse
