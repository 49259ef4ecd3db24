#pragma once

#include <numbers>

#include "sdk/src/attitude/rotation.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse {

constexpr double kDegree = std::numbers::pi / 180.0;

/// What the sensors of a phone turned `body_to_enu` and turning by `turn_rate_radps` (body) say; dip 60 degrees, 50 microtesla.
inline MargSample sense(double time_s, Quaternion body_to_enu, Vector3 turn_rate_radps = {}) {
  MargSample sample;
  sample.time = PhoneTime{from_seconds(time_s)};
  sample.acceleration_mps2 = unrotate(body_to_enu, {0, 0, 9.81});
  sample.turn_rate_radps = turn_rate_radps;
  sample.field_ut = unrotate(body_to_enu, Vector3{0, 0.5, -std::sqrt(0.75)} * 50.0);
  return sample;
}

/// Body y axis along `azimuth_deg` (clockwise from north), tipped up by `pitch_deg` and then rolled about y by `roll_deg`.
inline Quaternion held(double azimuth_deg, double pitch_deg = 0.0, double roll_deg = 0.0) {
  return about_up(-azimuth_deg * kDegree) * from_rotation_vector({pitch_deg * kDegree, 0, 0}) *
         from_rotation_vector({0, roll_deg * kDegree, 0});
}

}  // namespace wayfuse
