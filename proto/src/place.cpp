#include "wayfuse/proto/place.hpp"

#include <cmath>
#include <numbers>

namespace wayfuse {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSemiMajor_m = 6378137.0;                 // WGS84 a
constexpr double kEccentricity2 = 6.69437999014e-3;        // WGS84 e^2

struct Radii {
  double meridian_m;       // north-south
  double prime_vertical_m; // east-west, times cos(latitude)
};

Radii radii_at(double latitude_deg) {
  const double s = std::sin(latitude_deg * kDegree);
  const double w2 = 1.0 - kEccentricity2 * s * s;
  return {kSemiMajor_m * (1.0 - kEccentricity2) / (w2 * std::sqrt(w2)), kSemiMajor_m / std::sqrt(w2)};
}

// Second-order terms keep the plane within a centimetre over 5 km: the parallels' length changes with latitude.
constexpr int kIterations = 3;

}  // namespace

double distance_m(BuildingPoint a, BuildingPoint b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }

GeoPoint Georeference::to_geo(BuildingPoint point) const {
  const double c = std::cos(y_axis_azimuth_rad);
  const double s = std::sin(y_axis_azimuth_rad);
  const double east_m = point.x_m * c + point.y_m * s;
  const double north_m = -point.x_m * s + point.y_m * c;
  double latitude_deg = origin.latitude_deg;
  for (int i = 0; i < kIterations; ++i) {
    const double middle = 0.5 * (latitude_deg + origin.latitude_deg);
    latitude_deg = origin.latitude_deg + north_m / radii_at(middle).meridian_m / kDegree;
  }
  const double middle = 0.5 * (latitude_deg + origin.latitude_deg);
  const double parallel_m = radii_at(middle).prime_vertical_m * std::cos(middle * kDegree);
  return {latitude_deg, origin.longitude_deg + east_m / parallel_m / kDegree};
}

BuildingPoint Georeference::to_building(GeoPoint point) const {
  const double middle = 0.5 * (point.latitude_deg + origin.latitude_deg);
  const Radii radii = radii_at(middle);
  const double north_m = (point.latitude_deg - origin.latitude_deg) * kDegree * radii.meridian_m;
  const double longitude_deg = std::remainder(point.longitude_deg - origin.longitude_deg, 360.0);
  const double east_m = longitude_deg * kDegree * radii.prime_vertical_m * std::cos(middle * kDegree);
  const double c = std::cos(y_axis_azimuth_rad);
  const double s = std::sin(y_axis_azimuth_rad);
  return {east_m * c - north_m * s, east_m * s + north_m * c};
}

Heading Georeference::to_building(Heading true_heading) const { return true_heading.turned_by(y_axis_azimuth_rad); }
Heading Georeference::to_true(Heading building_heading) const { return building_heading.turned_by(-y_axis_azimuth_rad); }

bool contains(const Polygon& polygon, BuildingPoint point) {
  bool inside = false;
  for (const Ring& ring : polygon.rings) {
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const BuildingPoint a = ring[i];
      const BuildingPoint b = ring[j];
      if ((a.y_m > point.y_m) != (b.y_m > point.y_m) &&
          point.x_m < (b.x_m - a.x_m) * (point.y_m - a.y_m) / (b.y_m - a.y_m) + a.x_m) {
        inside = !inside;
      }
    }
  }
  return inside;
}

}  // namespace wayfuse
