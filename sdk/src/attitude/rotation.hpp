#pragma once

#include <cmath>

#include "wayfuse/sdk/heading_estimator.hpp"
#include "wayfuse/sdk/marg.hpp"

// Vectors and unit quaternions (body -> east, north, up), small enough to stand in line.
namespace wayfuse {

inline Vector3 operator+(Vector3 a, Vector3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector3 operator-(Vector3 a, Vector3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector3 operator*(Vector3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline double dot(Vector3 a, Vector3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector3 cross(Vector3 a, Vector3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double norm(Vector3 a) { return std::sqrt(dot(a, a)); }
inline bool finite(Vector3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

inline Quaternion operator*(Quaternion a, Quaternion b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
inline Quaternion conjugate(Quaternion q) { return {q.w, -q.x, -q.y, -q.z}; }
inline Quaternion normalized(Quaternion q) {
  const double s = 1.0 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w * s, q.x * s, q.y * s, q.z * s};
}
inline Vector3 rotate(Quaternion q, Vector3 v) {
  const Vector3 u{q.x, q.y, q.z};
  const Vector3 t = cross(u, v) * 2.0;
  return v + t * q.w + cross(u, t);
}
inline Vector3 unrotate(Quaternion q, Vector3 v) { return rotate(conjugate(q), v); }

/// The turn by `angle_rad` (axis times angle).
inline Quaternion from_rotation_vector(Vector3 angle_rad) {
  const double half = 0.5 * norm(angle_rad);
  const double s = half < 1e-6 ? 0.5 * (1.0 - half * half / 6.0) : 0.5 * std::sin(half) / half;
  return {std::cos(half), angle_rad.x * s, angle_rad.y * s, angle_rad.z * s};
}
/// The turn about the vertical, counter-clockwise seen from above.
inline Quaternion about_up(double angle_rad) { return {std::cos(0.5 * angle_rad), 0, 0, std::sin(0.5 * angle_rad)}; }

/// The shortest turn that takes the unit vector `from` to straight up.
inline Quaternion to_up(Vector3 from) {
  if (from.z < -1.0 + 1e-12) return {0, 1, 0, 0};  // upside down: any horizontal axis will do
  return normalized({1.0 + from.z, from.y, -from.x, 0.0});
}

/// Heading of the body's y axis; of its negative z axis (where the camera looks) while y stands vertical.
inline Heading heading_of(Quaternion q) {
  const double east = 2.0 * (q.x * q.y - q.w * q.z), north = 1.0 - 2.0 * (q.x * q.x + q.z * q.z);
  if (east * east + north * north > 1e-8) return Heading::from_vector(east, north);
  return Heading::from_vector(-2.0 * (q.x * q.z + q.w * q.y), -2.0 * (q.y * q.z - q.w * q.x));
}

/// Turns a magnetic attitude to true axes where the declination is known.
inline void refer_to(const MagneticField& expected, Attitude& attitude) {
  if (attitude.reference != HeadingReference::kMagnetic || expected.norm_ut <= 0.0) return;
  attitude.body_to_enu = about_up(-expected.declination_rad) * attitude.body_to_enu;
  attitude.heading = attitude.heading.turned_by(-expected.declination_rad);
  attitude.reference = HeadingReference::kTrue;
}

}  // namespace wayfuse
