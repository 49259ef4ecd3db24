#pragma once

#include <optional>
#include <vector>

#include "admin/plan/plan.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// The same place on the plan and on the earth.
struct ControlPoint {
  BuildingPoint local;
  GeoPoint geo;
};

/// How the plan lies on the earth: a turn and a shift, no stretching, for metres must stay metres. What a stretch would have
/// bought is said beside it: it tells wrong scales and mixed-up points.
struct GeoreferenceFit {
  Georeference georeference;
  std::vector<double> residual_m;        ///< a point
  std::vector<double> without_it_m;      ///< how far the others put it; empty below three points
  double rms_m = 0.0;
  double scale = 1.0;                    ///< metres on the earth a metre on the plan
  std::optional<double> scale_x;         ///< of the plan's own axes, from three points not in a line on
  std::optional<double> scale_y;
  std::optional<double> shear_rad;       ///< by which their right angle is off
  std::vector<PlanCheck> checks;
};

/// kOutOfRange for fewer than two points or points in one place.
Result<GeoreferenceFit> fit_georeference(const std::vector<ControlPoint>& points);

}  // namespace wayfuse
