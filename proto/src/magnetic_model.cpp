#include "wayfuse/proto/magnetic_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace wayfuse {
namespace {

constexpr int kDegree = 6;
constexpr double kEpoch = 2020.0;
constexpr double kReference_m = 6371200.0;  // the model's sphere
constexpr double kSemiMajor_m = 6378137.0;  // WGS84
constexpr double kSemiMinor_m = 6356752.3142;
constexpr double kRadian = std::numbers::pi / 180.0;

// Schmidt semi-normalised Gauss coefficients, nanotesla, and their change a year.
struct Gauss {
  int n, m;
  double g, h, g_change, h_change;
};
constexpr std::array<Gauss, 27> kWmm2020 = {{
    {1, 0, -29404.5, 0.0, 6.7, 0.0},      {1, 1, -1450.7, 4652.9, 7.7, -25.1}, {2, 0, -2500.0, 0.0, -11.5, 0.0},
    {2, 1, 2982.0, -2991.6, -7.1, -30.2}, {2, 2, 1676.8, -734.8, -2.2, -23.9}, {3, 0, 1363.9, 0.0, 2.8, 0.0},
    {3, 1, -2381.0, -82.2, -6.2, 5.7},    {3, 2, 1236.2, 241.8, 3.4, -1.0},    {3, 3, 525.7, -542.9, -12.2, 1.1},
    {4, 0, 903.1, 0.0, -1.1, 0.0},        {4, 1, 809.4, 282.0, -1.6, 0.2},     {4, 2, 86.2, -158.4, -6.0, 6.9},
    {4, 3, -309.4, 199.8, 5.4, 3.7},      {4, 4, 47.9, -350.1, -5.5, -5.6},    {5, 0, -234.4, 0.0, -0.3, 0.0},
    {5, 1, 363.1, 47.7, 0.6, 0.1},        {5, 2, 187.8, 208.4, -0.7, 2.5},     {5, 3, -140.7, -121.3, 0.1, -0.9},
    {5, 4, -151.2, 32.2, 1.2, 3.0},       {5, 5, 13.7, 99.1, 1.0, 0.5},        {6, 0, 65.9, 0.0, -0.6, 0.0},
    {6, 1, 65.6, -19.1, -0.4, 0.1},       {6, 2, 73.0, 25.0, 0.5, -1.8},       {6, 3, -121.5, 52.7, 1.4, -1.4},
    {6, 4, -36.2, -64.4, -1.4, 0.9},      {6, 5, 13.5, 9.0, 0.0, 0.1},         {6, 6, -64.7, 68.1, 0.8, 1.0},
}};

// Associated Legendre functions of cos(colatitude) and their slopes in the colatitude.
struct Legendre {
  double p[kDegree + 1][kDegree + 1] = {};
  double slope[kDegree + 1][kDegree + 1] = {};

  explicit Legendre(double colatitude_rad) {
    const double c = std::cos(colatitude_rad), s = std::sin(colatitude_rad);
    p[0][0] = 1.0;
    for (int n = 1; n <= kDegree; ++n) {
      const double diagonal = n == 1 ? 1.0 : std::sqrt((2.0 * n - 1.0) / (2.0 * n));
      p[n][n] = diagonal * s * p[n - 1][n - 1];
      slope[n][n] = diagonal * (s * slope[n - 1][n - 1] + c * p[n - 1][n - 1]);
      for (int m = 0; m < n; ++m) {
        const double before = n > 1 && m <= n - 2 ? std::sqrt((n - 1.0) * (n - 1.0) - m * m) : 0.0;
        const double root = std::sqrt(static_cast<double>(n * n - m * m));
        const double p_before = n > 1 ? p[n - 2][m] : 0.0, slope_before = n > 1 ? slope[n - 2][m] : 0.0;
        p[n][m] = ((2.0 * n - 1.0) * c * p[n - 1][m] - before * p_before) / root;
        slope[n][m] = ((2.0 * n - 1.0) * (c * slope[n - 1][m] - s * p[n - 1][m]) - before * slope_before) / root;
      }
    }
  }
};

}  // namespace

MagneticField main_field(GeoPoint point, double year) {
  // From the ellipsoid's latitude to the sphere's, and the distance from the earth's centre.
  const double geodetic_rad = std::clamp(point.latitude_deg, -89.9, 89.9) * kRadian;
  const double longitude_rad = point.longitude_deg * kRadian;
  const double a2 = kSemiMajor_m * kSemiMajor_m, b2 = kSemiMinor_m * kSemiMinor_m;
  const double ca = a2 * std::cos(geodetic_rad), sb = b2 * std::sin(geodetic_rad);
  const double root = std::hypot(kSemiMajor_m * std::cos(geodetic_rad), kSemiMinor_m * std::sin(geodetic_rad));
  const double radius_m = std::hypot(ca, sb) / root;
  const double geocentric_rad = std::atan2(sb, ca);
  const Legendre legendre(std::numbers::pi / 2 - geocentric_rad);
  const double drift_years = std::clamp(year - kEpoch, -5.0, 10.0);

  double north = 0.0, east = 0.0, down = 0.0;  // nanotesla, on the sphere
  for (const Gauss& row : kWmm2020) {
    const double g = row.g + drift_years * row.g_change;
    const double h = row.h + drift_years * row.h_change;
    const double falling = std::pow(kReference_m / radius_m, row.n + 2);
    const double cosine = std::cos(row.m * longitude_rad), sine = std::sin(row.m * longitude_rad);
    north += falling * (g * cosine + h * sine) * legendre.slope[row.n][row.m];
    east += falling * row.m * (g * sine - h * cosine) * legendre.p[row.n][row.m] / std::cos(geocentric_rad);
    down -= falling * (row.n + 1) * (g * cosine + h * sine) * legendre.p[row.n][row.m];
  }
  const double tilt = geocentric_rad - geodetic_rad;
  const double north_level = north * std::cos(tilt) - down * std::sin(tilt);
  const double down_level = north * std::sin(tilt) + down * std::cos(tilt);
  const double level = std::hypot(north_level, east);
  return {std::atan2(east, north_level), std::atan2(down_level, level), std::hypot(level, down_level) * 1e-3};
}

}  // namespace wayfuse
