#pragma once

#include "sdk/src/attitude/rotation.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

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

struct WalkingDirectionSettings {
  double memory_s = 8.0;            ///< how long gait is averaged; larger is steadier and slower after a change of carrying
  double trust_after_s = 4.0;       ///< walking needed before the gait's direction is used
  double gait_sigma_rad = 0.45;     ///< of a direction from gait (26 degrees)
  double held_sigma_rad = 0.14;     ///< of the hand's direction against the walker's (8 degrees)
  double held_rate_radps = 1.4;     ///< more turning than this is a pocket or a swinging arm
  double swinging_rate_radps = 2.6;
  double running_swing_mps2 = 6.0;  ///< runners push off differently: their gait is not read
};

/// Tells how the phone is carried and where its owner walks, apart from where it points.
///
/// A walker is an inverted pendulum: lowest and fastest when both feet are down, highest and slowest over the standing leg. So
/// forward acceleration moves with the change of vertical acceleration, and the mean of their product, taken as a vector in a
/// frame that turns with the walker, points ahead, whichever way the phone is carried. In the hand before the face the phone's
/// own facing is better and is used. A plain struct.
struct WalkingDirection {
  Carrying carrying = Carrying::kUnknown;

  /// One acceleration in the level frame (east-ish, north-ish, up) and the turn about the vertical since the one before.
  void feed(const WalkingDirectionSettings& settings, Vector3 acceleration_level, double turned_rad, double dt_s, bool walking);
  /// One turn rate and gravity's direction, both in the body.
  void carry(const WalkingDirectionSettings& settings, Vector3 turn_rate_radps, Vector3 up_body, double dt_s, bool at_rest);

  /// Of the walker; `turn_to_east` leads from the level frame to the attitude's own axes.
  Heading direction(const WalkingDirectionSettings& settings, const Attitude& attitude, double swing_mps2) const;
  double sigma_rad(const WalkingDirectionSettings& settings, const Attitude& attitude, double swing_mps2) const;

 private:
  bool by_gait(const WalkingDirectionSettings& settings, double swing_mps2) const;

  Vector3 first_, second_;           // low-pass, level frame
  double mean_x_ = 0.0, mean_y_ = 0.0;
  double ahead_x_ = 0.0, ahead_y_ = 0.0;
  double walked_s_ = 0.0;
  double square_rate_ = 0.0;
  Vector3 up_;
  bool started_ = false, carried_ = false;
};

}  // namespace wayfuse
