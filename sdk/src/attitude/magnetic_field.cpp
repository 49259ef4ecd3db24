#include "sdk/src/attitude/magnetic_field.hpp"

#include <algorithm>

namespace wayfuse {
namespace {

Vector3 times(const Matrix3& r, Vector3 v) {
  return {r[0][0] * v.x + r[0][1] * v.y + r[0][2] * v.z, r[1][0] * v.x + r[1][1] * v.y + r[1][2] * v.z,
          r[2][0] * v.x + r[2][1] * v.y + r[2][2] * v.z};
}
Vector3 transposed_times(const Matrix3& r, Vector3 v) {
  return {r[0][0] * v.x + r[1][0] * v.y + r[2][0] * v.z, r[0][1] * v.x + r[1][1] * v.y + r[2][1] * v.z,
          r[0][2] * v.x + r[1][2] * v.y + r[2][2] * v.z};
}
// Of a symmetric positive definite 3 x 3 system, by the adjugate.
Vector3 solved(const Matrix3& a, Vector3 b) {
  const double c00 = a[1][1] * a[2][2] - a[1][2] * a[2][1], c01 = a[0][2] * a[2][1] - a[0][1] * a[2][2],
               c02 = a[0][1] * a[1][2] - a[0][2] * a[1][1];
  const double c11 = a[0][0] * a[2][2] - a[0][2] * a[2][0], c12 = a[0][2] * a[1][0] - a[0][0] * a[1][2];
  const double c22 = a[0][0] * a[1][1] - a[0][1] * a[1][0];
  const double s = 1.0 / (a[0][0] * c00 + a[0][1] * c01 + a[0][2] * c02);
  return {s * (c00 * b.x + c01 * b.y + c02 * b.z), s * (c01 * b.x + c11 * b.y + c12 * b.z), s * (c02 * b.x + c12 * b.y + c22 * b.z)};
}

}  // namespace

void MagneticSums::add(const MagneticSums& other) {
  count += other.count;
  body = body + other.body;
  inertial = inertial + other.inertial;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rotation[i][j] += other.rotation[i][j];
  }
  square += other.square;
}

void MagneticSums::scale(double factor) {
  count *= factor;
  body = body * factor;
  inertial = inertial * factor;
  for (auto& row : rotation) {
    for (double& value : row) value *= factor;
  }
  square *= factor;
}

void HardIron::clear() {
  for (MagneticSums& second : ring) second = {};
  current = {};
  seconds_in_current = 0.0;
}

MagneticSums HardIron::newest(int how_many) const {
  MagneticSums sums;
  for (int k = 1; k <= how_many; ++k) sums.add(ring[(next - k + kSeconds) % kSeconds]);
  return sums;
}

HardIron::News HardIron::add(const HardIronSettings& settings, const MagneticSums& block, double dt_s) {
  current.add(block);
  seconds_in_current += dt_s;
  if (seconds_in_current < 1.0) return News::kNone;
  ring[next] = current;
  next = (next + 1) % kSeconds;
  current = {};
  seconds_in_current = 0.0;
  return solve(settings);
}

namespace {

// (I - E[R]' E[R]) b = E[m] - E[R]' E[R m] over a window, and what any b leaves unexplained.
struct Fit {
  Matrix3 a;
  Vector3 right;
  double unexplained = 0.0;

  explicit Fit(MagneticSums sums) {
    sums.scale(1.0 / sums.count);
    const Matrix3& r = sums.rotation;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) a[i][j] = (i == j ? 1.0 : 0.0) - (r[0][i] * r[0][j] + r[1][i] * r[1][j] + r[2][i] * r[2][j]);
    }
    right = sums.body - transposed_times(r, sums.inertial);
    unexplained = sums.square - dot(sums.inertial, sums.inertial);
  }
  double residual(Vector3 b) const { return std::max(0.0, unexplained - 2.0 * dot(b, right) + dot(b, times(a, b))); }
  Vector3 best_near(Vector3 b, double ridge) const {
    Matrix3 ridged;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) ridged[i][j] = a[i][j] + (i == j ? ridge : 0.0);
    }
    return b + solved(ridged, right - times(a, b));
  }
  double turning() const { return a[0][0] + a[1][1] + a[2][2]; }
};

}  // namespace

HardIron::News HardIron::solve(const HardIronSettings& settings) {
  const MagneticSums recent = newest(3), all = newest(kSeconds);
  if (all.count <= 0.0) return News::kNone;
  if (recent.count > 0.0) {
    const Fit fit(recent);
    if (fit.residual(fit.best_near(offset_ut, settings.ridge)) > settings.step_ut * settings.step_ut) {
      clear();
      return News::kStep;
    }
  }
  const Fit fit(all);
  const double floor = settings.floor_ut * settings.floor_ut;
  const Vector3 found = fit.best_near(offset_ut, settings.ridge);
  if (norm(found) > settings.most_ut) return News::kNone;
  const double left = fit.residual(found) + floor, now = fit.residual(offset_ut) + floor;
  const double ratio = left / now;
  const bool in_use = dot(offset_ut, offset_ut) > 0.0;
  if (in_use && fit.turning() > 1.0 && fit.residual({}) + floor < settings.zero_ratio * left) {
    offset_ut = {};
    return News::kMoved;
  }
  double share = std::clamp((settings.refuse_ratio - ratio) / (settings.refuse_ratio - settings.accept_ratio), 0.0, 1.0);
  if (in_use) share = std::max(share, settings.refine_gain);
  if (share <= 0.0) return News::kNone;
  offset_ut = offset_ut + (found - offset_ut) * share;
  return News::kMoved;
}

double MagneticHeading::heading_rad(Vector3 offset_ut) const {
  const Vector3 north = field - times(rotation, offset_ut);
  return std::atan2(north.x, north.y);
}

double MagneticHeading::away_rad(const MagneticSums& block, Vector3 offset) const {
  if (!pointed) return 0.0;
  const Vector3 now = block.inertial - times(block.rotation, offset), mean = field - times(rotation, offset);
  return std::atan2(now.x * mean.y - now.y * mean.x, now.x * mean.x + now.y * mean.y);
}

void MagneticHeading::average(const MagneticSums& block, double away, double gain, double dt_s) {
  const double n = 1.0 / block.count;
  spread_rad2 += std::min(1.0, dt_s / 20.0) * (away * away - spread_rad2);
  field = field + (block.inertial * n - field) * gain;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rotation[i][j] += (block.rotation[i][j] * n - rotation[i][j]) * gain;
  }
  pointed = true;
}

void MagneticHeading::freeze(Vector3 offset) {
  field = field - times(rotation, offset);
  for (auto& row : rotation) {
    for (double& value : row) value = 0.0;
  }
}

namespace {

// How far a field is from a reference, in the scales of the settings.
double mismatch_square(const MagneticHeadingSettings& s, double norm_ut, double dip_rad, double reference_ut, double reference_rad) {
  const double norms = (norm_ut - reference_ut) / (s.norm_scale * reference_ut), dips = (dip_rad - reference_rad) / s.dip_scale_rad;
  return norms * norms + dips * dips;
}

}  // namespace

void MagneticHeading::follow_candidate(const MagneticHeadingSettings& s, double norm_now, double dip_now, double dt_s) {
  const bool steady = candidate_s > 0.0 && mismatch_square(s, norm_now, dip_now, candidate_norm_ut, candidate_dip_rad) < 1.0;
  if (!steady) {
    candidate_norm_ut = norm_now;
    candidate_dip_rad = dip_now;
    candidate_s = dt_s;
    return;
  }
  candidate_s += dt_s;
  const double gain = dt_s / std::min(candidate_s, 5.0);
  candidate_norm_ut += gain * (norm_now - candidate_norm_ut);
  candidate_dip_rad += gain * (dip_now - candidate_dip_rad);
}

double MagneticHeading::judge(const MagneticHeadingSettings& s, const MagneticSums& block, Vector3 offset, double dt_s) {
  const double n = 1.0 / block.count;
  const Vector3 h = block.inertial * n - times(block.rotation, offset) * n;
  const double square = block.square * n - 2.0 * n * dot(block.body, offset) + dot(offset, offset);
  const double norm_now = std::sqrt(std::max(0.0, square));
  const double dip_now = std::atan2(-h.z, std::hypot(h.x, h.y));
  switched = false;
  if (norm_ut <= 0.0) {
    norm_ut = norm_now;
    dip_rad = dip_now;
    averaged_s = support_s = 0.0;
  }
  const double mismatch = mismatch_square(s, norm_now, dip_now, norm_ut, dip_rad), root = 1.0 / (1.0 + mismatch);
  const double weight = mismatch < s.odd_square ? root * root : 0.0;
  quality += std::min(1.0, dt_s / 5.0) * (weight - quality);
  if (mismatch < 1.0) {
    support_s += dt_s;
    candidate_s = 0.0;
    averaged_s = std::min(averaged_s + dt_s, s.reference_s);
    norm_ut += dt_s / averaged_s * (norm_now - norm_ut);
    dip_rad += dt_s / averaged_s * (dip_now - dip_rad);
    return weight;
  }
  follow_candidate(s, norm_now, dip_now, dt_s);
  if (candidate_s < std::min(s.accept_field_s, std::max(s.least_support_s, support_s))) return weight;
  switched = support_s < candidate_s;
  support_s = candidate_s;
  norm_ut = candidate_norm_ut;
  dip_rad = candidate_dip_rad;
  candidate_s = 0.0;
  averaged_s = 1.0;
  return 1.0;
}

}  // namespace wayfuse
