#include "server/locating/propagation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wayfuse {
namespace {

constexpr double kMostCells = 40000.0;

class PropagationLocator final : public Locator {
 public:
  explicit PropagationLocator(const Propagation& model) : model_(model) {}
  std::unique_ptr<Locator> clone() const override { return std::make_unique<PropagationLocator>(*this); }
  int transmitters_known() const override { return static_cast<int>(scan_.levels.size()); }
  int transmitters_unknown() const override { return scan_.unknown; }
  std::span<const FloorProbability> floors() const override { return floors_; }

  std::optional<Fix> locate(const RssScan& scan) override {
    model_.map().know(scan, scan_);
    std::erase_if(scan_.levels, [&](const auto& level) { return !model_.laws()[level.transmitter]; });
    if (scan_.levels.empty()) return std::nullopt;
    std::ranges::sort(scan_.levels, [](const auto& a, const auto& b) {
      return a.rss_dbm != b.rss_dbm ? a.rss_dbm > b.rss_dbm : a.transmitter < b.transmitter;
    });
    vote_for_floors(scan_.levels, model_.laws(), floors_);
    return search(floors_.front().floor);
  }

 private:
  std::optional<Fix> search(FloorOrdinal floor) const {
    const auto& ground = *std::ranges::find(model_.grounds(), floor, &Propagation::Ground::floor);
    double least = std::numeric_limits<double>::infinity();
    BuildingPoint best;
    int used = 0;
    for (int row = 0; row < ground.rows; ++row) {
      for (int column = 0; column < ground.columns; ++column) {
        const BuildingPoint cell{ground.corner.x_m + column * ground.cell_m, ground.corner.y_m + row * ground.cell_m};
        double squared_db = 0.0;
        used = 0;
        for (const auto& level : scan_.levels) {
          const PathLoss& law = *model_.laws()[level.transmitter];
          if (law.transmitter.floor != floor || used == model_.settings().strongest) continue;
          const double error_db = static_cast<double>(level.rss_dbm) - law.level_dbm(distance_m(cell, law.transmitter.point));
          squared_db += error_db * error_db;
          ++used;
        }
        if (squared_db < least) {
          least = squared_db;
          best = cell;
        }
      }
    }
    if (used == 0) return std::nullopt;
    // A level error of s dB at exponent n is a relative distance error of s ln10 / 10n; about 10 m off, among `used` of them.
    const double level_error_db = std::sqrt(least / used);
    return Fix{{best, floor}, std::max(ground.cell_m, level_error_db), transmitters_known()};
  }

  const Propagation& model_;
  KnownScan scan_;
  std::vector<FloorProbability> floors_;
};

}  // namespace

Propagation::Propagation(std::shared_ptr<const RadioMap> map, const PropagationSettings& settings)
    : map_(std::move(map)), settings_(settings), laws_(fit_path_loss(*map_)) {
  for (const FloorOrdinal floor : map_->floors()) {
    double least_x = INFINITY, most_x = -INFINITY, least_y = INFINITY, most_y = -INFINITY;
    for (const MapPoint& point : map_->points()) {
      if (point.place.floor != floor) continue;
      least_x = std::min(least_x, point.place.point.x_m);
      most_x = std::max(most_x, point.place.point.x_m);
      least_y = std::min(least_y, point.place.point.y_m);
      most_y = std::max(most_y, point.place.point.y_m);
    }
    const double width_m = most_x - least_x, depth_m = most_y - least_y;
    const double coarse_m = std::sqrt((width_m + settings.cell_m) * (depth_m + settings.cell_m) / kMostCells);
    const double cell_m = std::max(settings.cell_m, coarse_m);
    grounds_.push_back({floor, {least_x, least_y}, cell_m, 1 + static_cast<int>(width_m / cell_m), 1 + static_cast<int>(depth_m / cell_m)});
  }
}

std::unique_ptr<Locator> Propagation::make() const { return std::make_unique<PropagationLocator>(*this); }

}  // namespace wayfuse
