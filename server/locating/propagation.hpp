#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "server/locating/catalogue.hpp"
#include "server/locating/path_loss.hpp"

namespace wayfuse {

struct PropagationSettings {
  double cell_m = 1.0;             ///< of the modelled map, 0.25..10
  int strongest = 16;              ///< transmitters used, 1..64
};

/// The propagation-model method (RADAR's second): a fingerprint map computed from the fitted path-loss laws instead of
/// surveyed, and the cell whose modelled levels are nearest in signal space.
///
/// Only transmitters of the floor speak, only their levels count: a modelled map cannot say who is *not* heard. Cells cover the
/// surveyed ground; at most 40,000 a floor, coarser beyond.
class Propagation final : public LocatorModel {
 public:
  Propagation(std::shared_ptr<const RadioMap> map, const PropagationSettings& settings);
  std::unique_ptr<Locator> make() const override;

  struct Ground {
    FloorOrdinal floor;
    BuildingPoint corner;
    double cell_m;
    int columns;
    int rows;
  };
  const PropagationSettings& settings() const { return settings_; }
  const RadioMap& map() const { return *map_; }
  const std::vector<std::optional<PathLoss>>& laws() const { return laws_; }
  const std::vector<Ground>& grounds() const { return grounds_; }

 private:
  std::shared_ptr<const RadioMap> map_;
  PropagationSettings settings_;
  std::vector<std::optional<PathLoss>> laws_;
  std::vector<Ground> grounds_;
};

}  // namespace wayfuse
