#pragma once

#include "sdk/src/attitude/rotation.hpp"

namespace wayfuse {

struct InertialKalmanSettings {
  double velocity_sigma_mps_rts = 0.45;        ///< of the pseudo-measurement "velocity is 0", m/s times root second; larger averages gravity longer
  double tilt_noise_rad_prts = 0.0026;         ///< tilt random walk, rad per root second (0.15 degrees)
  double tilt_noise_per_rate_rts = 0.0017;     ///< and per rad/s of turning: scale and alignment errors
  double heading_noise_rad_prts = 0.0061;      ///< heading random walk (0.35 degrees)
  double bias_sigma_radps = 0.0045;            ///< at the start (0.26 degrees a second)
  double bias_walk_radps_prts = 2e-5;          ///< how fast it wanders
  double bias_most_radps = 0.035;              ///< (2 degrees a second)
  double rest_rate_sigma_radps_rts = 0.0025;   ///< of the mean rate at rest (0.14 degrees a second times root second)
  double motion_bias_gain = 0.5;               ///< share of the optimal bias correction taken while moving, 0..1
  double shake_velocity = 0.02;                ///< growth of the velocity's variance per (m/s2)^2 of shaking: runners fly
  double shake_bias = 0.03;                    ///< fall of the bias gain per (m/s2)^4 of shaking: walking hardly, running much
};

/// The error-state Kalman filter behind the strap-down: tilt, heading, horizontal velocity, gyroscope bias.
///
/// Works in blocks. Errors are true minus estimated, in the inertial frame (level, heading free): with db the error of the bias
/// and R body -> inertial, the attitude error turns by -R db, and the velocity error grows by g (tilt_y, -tilt_x). The only
/// knowledge is that a phone goes nowhere fast (velocity = 0, weakly), and that at rest its gyroscope reads its bias. A plain
/// struct: copying it saves it.
struct InertialKalman {
  static constexpr int kTilt = 0, kHeading = 2, kVelocity = 3, kBias = 5, kStates = 8;

  double p[kStates][kStates] = {};
  double velocity_mps[2] = {};       ///< east, north
  Vector3 bias_radps;                ///< body

  /// What one block asks of the attitude: a small turn in the inertial frame.
  using Correction = Vector3;

  void start(const InertialKalmanSettings& settings, Vector3 bias_radps, double bias_sigma_radps);
  /// One block of `dt_s`: `rotation` body -> inertial row by row, specific force in the inertial frame, mean squared rate.
  void predict(const InertialKalmanSettings& settings, double dt_s, const double (&rotation)[3][3], Vector3 force_mps2,
               double mean_square_rate);
  /// velocity = 0, the less sure the more the phone is shaken (mean square of |force| - g).
  void stay(const InertialKalmanSettings& settings, double dt_s, bool at_rest, double shake_mps2_square, Correction& correction);
  /// At rest the mean rate is the bias.
  void rest(const InertialKalmanSettings& settings, double dt_s, Vector3 mean_rate_radps, Correction& correction);
  /// The compass, of variance `noise`, moved the heading by `gain` (0..1) times its innovation; the bias learns `bias_gain` of
  /// what it optimally would, tilt and velocity nothing.
  void pointed(double innovation_rad, double noise, double gain, double bias_gain);

 private:
  void take(int state, const double (&gain)[kStates], double innovation, double total);
  void update(int state, double innovation, double noise, double bias_gain, Correction& correction);
};

}  // namespace wayfuse
