#include "sdk/src/attitude/inertial_kalman.hpp"

#include <algorithm>

namespace wayfuse {
namespace {

constexpr double kGravity = 9.81;

}  // namespace

void InertialKalman::start(const InertialKalmanSettings& settings, Vector3 bias, double bias_sigma_radps) {
  *this = {};
  bias_radps = bias;
  p[0][0] = p[1][1] = 0.03 * 0.03 * 4;
  p[2][2] = 10.0;                                  // unknown
  p[3][3] = p[4][4] = 0.1;
  const double sigma = bias_sigma_radps > 0.0 ? bias_sigma_radps : settings.bias_sigma_radps;
  p[5][5] = p[6][6] = p[7][7] = sigma * sigma;
}

void InertialKalman::predict(const InertialKalmanSettings& s, double dt, const double (&r)[3][3], Vector3 force, double square_rate) {
  velocity_mps[0] += force.x * dt;
  velocity_mps[1] += force.y * dt;
  // P F' then F P, in place: rows tilt, heading += -R dt rows bias; rows velocity += g dt (tilt_y, -tilt_x) (of the old tilt).
  const double gdt = kGravity * dt;
  double column[kStates][5];
  for (int i = 0; i < kStates; ++i) {
    for (int k = 0; k < 3; ++k) column[i][k] = p[i][k] - dt * (r[k][0] * p[i][5] + r[k][1] * p[i][6] + r[k][2] * p[i][7]);
    column[i][3] = p[i][3] + gdt * p[i][1];
    column[i][4] = p[i][4] - gdt * p[i][0];
  }
  for (int j = 0; j < 5; ++j) {
    for (int k = 0; k < 3; ++k) {
      p[k][j] = column[k][j] - dt * (r[k][0] * column[5][j] + r[k][1] * column[6][j] + r[k][2] * column[7][j]);
    }
    p[3][j] = column[3][j] + gdt * column[1][j];
    p[4][j] = column[4][j] - gdt * column[0][j];
    for (int k = 5; k < kStates; ++k) p[k][j] = p[j][k] = column[k][j];
  }
  for (int k = 0; k < 5; ++k) {
    for (int j = 0; j < k; ++j) p[k][j] = p[j][k];
  }
  const double tilt = s.tilt_noise_rad_prts * s.tilt_noise_rad_prts + s.tilt_noise_per_rate_rts * s.tilt_noise_per_rate_rts * square_rate;
  const double heading = s.heading_noise_rad_prts * s.heading_noise_rad_prts;
  p[0][0] += tilt * dt;
  p[1][1] += tilt * dt;
  p[2][2] = std::min(p[2][2] + heading * dt, 10.0);
  for (int k = 5; k < kStates; ++k) {
    p[k][k] = std::min(p[k][k] + s.bias_walk_radps_prts * s.bias_walk_radps_prts * dt, s.bias_sigma_radps * s.bias_sigma_radps);
  }
}

// With the optimal gain P falls by c c' / total, c the state's column. Where the bias takes only a share a of its gain, its own
// part falls by (2 a - a^2) of that: still the covariance of what was done.
void InertialKalman::update(int state, double innovation, double noise, double bias_gain, Correction& correction) {
  const double inverse = 1.0 / (p[state][state] + noise);
  double column[kStates], gain[kStates], fall[kStates];
  for (int i = 0; i < kStates; ++i) {
    column[i] = p[state][i];
    fall[i] = 1.0;
    gain[i] = column[i] * inverse;
  }
  const double share = bias_gain * (2.0 - bias_gain);
  for (int i = 0; i < kBias; ++i) {
    for (int j = 0; j < kStates; ++j) p[i][j] -= column[i] * column[j] * inverse;
  }
  for (int j = kBias; j < kStates; ++j) {
    fall[j] = share;
    gain[j] *= bias_gain;
  }
  for (int i = kBias; i < kStates; ++i) {
    for (int j = 0; j < kStates; ++j) p[i][j] -= column[i] * column[j] * inverse * fall[j];
  }
  correction.x += gain[0] * innovation;
  correction.y += gain[1] * innovation;
  correction.z += gain[2] * innovation;
  velocity_mps[0] += gain[3] * innovation;
  velocity_mps[1] += gain[4] * innovation;
  bias_radps = bias_radps + Vector3{gain[5], gain[6], gain[7]} * innovation;
}

void InertialKalman::stay(const InertialKalmanSettings& s, double dt, bool at_rest, double shake,
                          Correction& correction) {
  const double noise = s.velocity_sigma_mps_rts * s.velocity_sigma_mps_rts * (1.0 + s.shake_velocity * shake) / dt;
  const double bias_gain = at_rest ? 1.0 : s.motion_bias_gain / (1.0 + s.shake_bias * shake * shake);
  update(kVelocity, -velocity_mps[0], noise, bias_gain, correction);
  update(kVelocity + 1, -velocity_mps[1], noise, bias_gain, correction);
  const auto within = [&](double& bias) { bias = std::clamp(bias, -s.bias_most_radps, s.bias_most_radps); };
  within(bias_radps.x);
  within(bias_radps.y);
  within(bias_radps.z);
}

void InertialKalman::rest(const InertialKalmanSettings& s, double dt, Vector3 rate, Correction& correction) {
  const double noise = s.rest_rate_sigma_radps_rts * s.rest_rate_sigma_radps_rts / dt;
  update(kBias, rate.x - bias_radps.x, noise, 1.0, correction);
  update(kBias + 1, rate.y - bias_radps.y, noise, 1.0, correction);
  update(kBias + 2, rate.z - bias_radps.z, noise, 1.0, correction);
}

// Any gain g leaves P - g c' - c g' + g g' S, with c the heading's column and S the innovation's variance.
void InertialKalman::pointed(double innovation, double noise, double heading_gain, double bias_gain) {
  const double total = p[kHeading][kHeading] + noise, share = bias_gain / total;
  double column[kStates], gain[kStates] = {};
  for (int i = 0; i < kStates; ++i) column[i] = p[i][kHeading];
  gain[kHeading] = heading_gain;
  for (int i = kBias; i < kStates; ++i) gain[i] = share * column[i];
  for (int i = 0; i < kStates; ++i) {
    for (int j = 0; j < kStates; ++j) p[i][j] += gain[i] * (gain[j] * total - column[j]) - column[i] * gain[j];
  }
  bias_radps = bias_radps + Vector3{gain[5], gain[6], gain[7]} * innovation;
}

}  // namespace wayfuse
