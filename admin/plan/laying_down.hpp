#pragma once

#include <optional>
#include <vector>

#include "admin/plan/features.hpp"
#include "admin/plan/plan.hpp"

namespace wayfuse {

/// Brings a file's coordinates into the building's frame.
class LayingDown {
 public:
  /// Guesses what the coordinates are where the options do not say, by the old `crs` member and by their size, and makes a
  /// georeference where the building has none; says so among the plan's checks.
  static LayingDown of(const std::vector<const FeatureCollection*>& files, const PlanOptions& options, Plan& plan);

  BuildingPoint operator()(RawPoint point) const;
  /// Closes the ring, mends a gap of up to a metre with a warning, refuses a larger one, and says what is unsound about it.
  std::optional<Ring> ring(const RawLine& raw, const std::string& where, Plan& plan) const;
  /// All sound rings of a feature as one polygon (even-odd).
  Polygon polygon(const Feature& feature, Plan& plan) const;
  Polyline line(const RawLine& raw) const;

 private:
  PlanOptions::Coordinates coordinates_ = PlanOptions::Coordinates::kWgs84;
  Georeference georeference_;
};

}  // namespace wayfuse
