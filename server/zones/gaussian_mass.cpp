#include "server/zones/gaussian_mass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace wayfuse {
namespace {

constexpr double kLeastVariance_m2 = 0.01;
constexpr double kNear = 6.0;    // standard deviations; exp(-18) is nothing
constexpr double kPiece = 3.0;

// Gauss-Legendre on -1..1, eight points (Abramowitz and Stegun, table 25.4).
constexpr std::array<double, 4> kNodes = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> kWeights = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};

// (1 - exp(-r2 / 2)) / r2, also where r2 is 0.
double kernel(double r2) { return r2 < 1e-8 ? 0.5 - r2 / 8 : -std::expm1(-r2 / 2) / r2; }

double piece(double h2, double from, double to) {
  const double middle = 0.5 * (from + to);
  const double half = 0.5 * (to - from);
  double sum = 0.0;
  for (std::size_t i = 0; i < kNodes.size(); ++i) {
    const double low = middle - half * kNodes[i];
    const double high = middle + half * kNodes[i];
    sum += kWeights[i] * (kernel(h2 + low * low) + kernel(h2 + high * high));
  }
  return half * sum;
}

struct Whitened {
  double u = 0.0;
  double v = 0.0;
};

/// Turns building coordinates into those where the distribution is the standard one: the inverse of a Cholesky factor.
class Whitening {
 public:
  Whitening(BuildingPoint mean, const Covariance& covariance) : mean_(mean) {
    const double xx = std::max(covariance.xx_m2, 0.0) + kLeastVariance_m2;
    const double yy = std::max(covariance.yy_m2, 0.0) + kLeastVariance_m2;
    const double bound = std::sqrt(xx * yy) * 0.999999;
    const double xy = std::clamp(covariance.xy_m2, -bound, bound);
    scale_x_ = 1.0 / std::sqrt(xx);
    lean_ = xy / xx;
    scale_y_ = 1.0 / std::sqrt(yy - xy * lean_);
  }
  Whitened operator()(BuildingPoint point) const {
    const double x_m = point.x_m - mean_.x_m;
    return {x_m * scale_x_, (point.y_m - mean_.y_m - lean_ * x_m) * scale_y_};
  }

 private:
  BuildingPoint mean_;
  double scale_x_;
  double scale_y_;
  double lean_;
};

// What the edge from a to b contributes: positive when the mean lies to its left.
double edge_mass(Whitened a, Whitened b) {
  const double length = std::hypot(b.u - a.u, b.v - a.v);
  if (length == 0.0) return 0.0;
  const double h = (a.u * b.v - a.v * b.u) / length;  // signed distance of the mean from the line
  if (h == 0.0) return 0.0;
  const double begin = (a.u * (b.u - a.u) + a.v * (b.v - a.v)) / length;
  const double end = begin + length;
  const auto far_from = [&](double from, double to) { return (std::atan(to / h) - std::atan(from / h)) / h; };
  const double h2 = h * h;
  double sum = 0.0;
  const double near_begin = std::abs(h) >= kNear ? end : std::clamp(-kNear, begin, end);
  const double near_end = std::abs(h) >= kNear ? end : std::clamp(kNear, begin, end);
  if (begin < near_begin) sum += far_from(begin, near_begin);
  if (near_end < end) sum += far_from(near_end, end);
  for (double from = near_begin; from < near_end;) {
    const double to = std::min(from + kPiece, near_end);
    sum += piece(h2, from, to);
    from = to;
  }
  return h * sum / (2 * std::numbers::pi);
}

double ring_mass(const Whitening& whiten, const Ring& ring) {
  if (ring.size() < 3) return 0.0;
  double sum = 0.0;
  Whitened before = whiten(ring.back());
  for (const BuildingPoint& point : ring) {
    const Whitened here = whiten(point);
    sum += edge_mass(before, here);
    before = here;
  }
  return std::abs(sum);  // whichever way round it was drawn
}

}  // namespace

double gaussian_mass(BuildingPoint mean, const Covariance& covariance, std::span<const SignedRing> rings) {
  const Whitening whiten(mean, covariance);
  double mass = 0.0;
  for (const SignedRing& part : rings) mass += (part.hole ? -1.0 : 1.0) * ring_mass(whiten, part.ring);
  return std::clamp(mass, 0.0, 1.0);
}

}  // namespace wayfuse
