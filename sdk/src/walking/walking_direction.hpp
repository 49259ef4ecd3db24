#pragma once

#include "sdk/src/attitude/rotation.hpp"

namespace wayfuse {

/// Where a walker who holds the phone before them faces.
///
/// Lying flat or tilted towards the face: the y axis projected, which is P1's heading. Held upright y points at the ceiling, so
/// the direction square to the screen's x axis is taken: the same while flat, and good at any pitch. Held sideways (x axis
/// vertical) the camera's direction, -z, is left.
inline Heading facing_of(Quaternion q) {
  const Vector3 x = rotate(q, {1, 0, 0});
  const double flat = std::hypot(x.x, x.y);
  if (flat > 0.5) return Heading::from_vector(-x.y, x.x);
  const Vector3 z = rotate(q, {0, 0, 1});
  return Heading::from_vector(-z.x, -z.y);
}

}  // namespace wayfuse
