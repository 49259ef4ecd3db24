#include "admin/plan/georeference_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wayfuse {
namespace {

using Severity = PlanCheck::Severity;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLeastBaseline_m = 1.0;
constexpr double kShortBaseline_m = 20.0;
constexpr double kScaleWarning = 0.02;
constexpr double kScaleError = 0.10;
constexpr double kShearWarning_rad = 2 * kDegree;
constexpr double kRmsWarning_m = 2.0;
constexpr double kSuspicious_m = 3.0;

BuildingPoint mean_of(const std::vector<BuildingPoint>& points) {
  BuildingPoint mean;
  for (const BuildingPoint& p : points) mean = {mean.x_m + p.x_m, mean.y_m + p.y_m};
  const auto n = static_cast<double>(points.size());
  return {mean.x_m / n, mean.y_m / n};
}

std::vector<BuildingPoint> about(const std::vector<BuildingPoint>& points, BuildingPoint mean) {
  std::vector<BuildingPoint> centred;
  for (const BuildingPoint& p : points) centred.push_back({p.x_m - mean.x_m, p.y_m - mean.y_m});
  return centred;
}

// The least-squares turn and shift from the plan to a plane (east, north) at the points' middle.
struct Laid {
  Georeference georeference;
  double scale = 1.0;
  double mirrored_gain = 0.0;            ///< how much better the plan would fit seen from below; > 1 = it is mirrored
  std::vector<BuildingPoint> plan;       ///< about their mean
  std::vector<BuildingPoint> earth;      ///< about theirs
};

Laid lay(const std::vector<ControlPoint>& points) {
  Georeference plane;
  for (const ControlPoint& point : points) {
    plane.origin.latitude_deg += point.geo.latitude_deg / static_cast<double>(points.size());
    // Longitudes are averaged near the first, so that the date line does no harm.
    plane.origin.longitude_deg += (points[0].geo.longitude_deg + std::remainder(point.geo.longitude_deg - points[0].geo.longitude_deg, 360.0)) /
                                  static_cast<double>(points.size());
  }
  std::vector<BuildingPoint> local;
  std::vector<BuildingPoint> earth;
  for (const ControlPoint& point : points) {
    local.push_back(point.local);
    earth.push_back(plane.to_building(point.geo));
  }
  const BuildingPoint local_mean = mean_of(local);
  const BuildingPoint earth_mean = mean_of(earth);
  Laid laid;
  laid.plan = about(local, local_mean);
  laid.earth = about(earth, earth_mean);
  double along = 0, across = 0, mirrored_along = 0, mirrored_across = 0, square = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [x, y] = laid.plan[i];
    const auto [e, n] = laid.earth[i];
    along += e * x + n * y;
    across += e * y - n * x;
    mirrored_along += -e * x + n * y;
    mirrored_across += e * y + n * x;
    square += x * x + y * y;
  }
  const double azimuth = std::atan2(across, along);
  laid.scale = std::hypot(along, across) / square;
  laid.mirrored_gain = std::hypot(mirrored_along, mirrored_across) / std::max(std::hypot(along, across), 1e-9);
  const double c = std::cos(azimuth);
  const double s = std::sin(azimuth);
  const BuildingPoint origin{earth_mean.x_m - (local_mean.x_m * c + local_mean.y_m * s),
                             earth_mean.y_m - (-local_mean.x_m * s + local_mean.y_m * c)};
  laid.georeference = {plane.to_geo(origin), azimuth};
  return laid;
}

double off_by_m(const Georeference& georeference, const ControlPoint& point) {
  return distance_m(georeference.to_building(point.geo), point.local);
}

// The plan's axes on the earth: the free linear map, column by column. Nothing where the points lie in a line.
void measure_axes(const Laid& laid, GeoreferenceFit& fit) {
  double xx = 0, xy = 0, yy = 0, ex = 0, ey = 0, nx = 0, ny = 0;
  for (std::size_t i = 0; i < laid.plan.size(); ++i) {
    const auto [x, y] = laid.plan[i];
    const auto [e, n] = laid.earth[i];
    xx += x * x, xy += x * y, yy += y * y;
    ex += e * x, ey += e * y, nx += n * x, ny += n * y;
  }
  const double determinant = xx * yy - xy * xy;
  if (laid.plan.size() < 3 || determinant < 1e-3 * (xx + yy) * (xx + yy)) return;
  const double x_east = (ex * yy - ey * xy) / determinant, x_north = (nx * yy - ny * xy) / determinant;
  const double y_east = (ey * xx - ex * xy) / determinant, y_north = (ny * xx - nx * xy) / determinant;
  fit.scale_x = std::hypot(x_east, x_north);
  fit.scale_y = std::hypot(y_east, y_north);
  fit.shear_rad = std::atan2(x_east * y_north - x_north * y_east, x_east * y_east + x_north * y_north) - std::numbers::pi / 2;
}

std::string text(const char* format, double value) {
  char out[160];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

void check(GeoreferenceFit& fit, const Laid& laid, double baseline_m) {
  const auto say = [&](Severity severity, const char* code, const std::string& feature, const std::string& detail) {
    fit.checks.push_back({severity, code, feature, detail});
  };
  const bool told_by_three = laid.plan.size() >= 3 && fit.scale_x.has_value();
  if (told_by_three && laid.mirrored_gain > 1.0) say(Severity::kError, "mirrored", "", "the plan fits the earth seen from below: are x and y, or latitude and longitude, mixed up?");
  const double stretch = std::abs(fit.scale - 1);
  if (stretch > kScaleError) {
    say(Severity::kError, "scale", "", text("a metre on the plan is %.3f m on the earth: is the plan in metres?", fit.scale));
  } else if (stretch > kScaleWarning) {
    say(Severity::kWarning, "scale", "", text("a metre on the plan is %.3f m on the earth", fit.scale));
  }
  if (fit.shear_rad && std::abs(*fit.shear_rad) > kShearWarning_rad) {
    say(Severity::kWarning, "shear", "", text("the plan's axes meet at %.1f degrees", 90 + *fit.shear_rad / kDegree));
  }
  if (fit.scale_x && std::abs(*fit.scale_x / *fit.scale_y - 1) > kScaleWarning) {
    say(Severity::kWarning, "scale", "", text("its x axis is stretched %.3f times as much as its y axis", *fit.scale_x / *fit.scale_y));
  }
  if (baseline_m < kShortBaseline_m) say(Severity::kWarning, "baseline", "", text("the points lie within %.1f m: the direction is poorly known", baseline_m));
  if (laid.plan.size() == 2) say(Severity::kNote, "two_points", "", "two points fit always: a third would show a mistake");
  if (fit.rms_m > kRmsWarning_m) say(Severity::kWarning, "residual", "", text("the points disagree by %.2f m (rms)", fit.rms_m));
  for (std::size_t i = 0; i < fit.without_it_m.size(); ++i) {
    std::vector<double> others = fit.residual_m;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const double worst_other = *std::ranges::max_element(others);
    if (fit.without_it_m[i] > kSuspicious_m && fit.without_it_m[i] > 2 * worst_other) {
      say(Severity::kWarning, "outlier", "control_points[" + std::to_string(i) + "]", text("the others put it %.1f m away", fit.without_it_m[i]));
    }
  }
}

}  // namespace

Result<GeoreferenceFit> fit_georeference(const std::vector<ControlPoint>& points) {
  if (points.size() < 2) return Fault{FaultCode::kOutOfRange, "control_points", "at least two are needed"};
  double baseline_m = 0;
  for (const ControlPoint& a : points) {
    for (const ControlPoint& b : points) baseline_m = std::max(baseline_m, distance_m(a.local, b.local));
  }
  if (baseline_m < kLeastBaseline_m) return Fault{FaultCode::kOutOfRange, "control_points", "all in one place: they give no direction"};
  const Laid laid = lay(points);
  GeoreferenceFit fit;
  fit.georeference = laid.georeference;
  fit.scale = laid.scale;
  double squares = 0;
  for (const ControlPoint& point : points) {
    fit.residual_m.push_back(off_by_m(fit.georeference, point));
    squares += fit.residual_m.back() * fit.residual_m.back();
  }
  fit.rms_m = std::sqrt(squares / static_cast<double>(points.size()));
  if (points.size() >= 3) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::vector<ControlPoint> others = points;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      fit.without_it_m.push_back(off_by_m(lay(others).georeference, points[i]));
    }
  }
  measure_axes(laid, fit);
  check(fit, laid, baseline_m);
  return fit;
}

}  // namespace wayfuse
