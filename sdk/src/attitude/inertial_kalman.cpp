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

// Any gain g leaves P - g c' - c g' + g g' S, with c the state's column and S the innovation's variance.
void InertialKalman::take(int state, const double (&gain)[kStates], double innovation, double total) {
  double column[kStates];
  for (int i = 0; i < kStates; ++i) column[i] = p[state][i];
  for (int i = 0; i < kStates; ++i) {
    const double rest = gain[i] * total - column[i];
    for (int j = 0; j <= i; ++j) p[j][i] = p[i][j] += rest * gain[j] - gain[i] * column[j];
  }
  velocity_mps[0] += gain[kVelocity] * innovation;
  velocity_mps[1] += gain[kVelocity + 1] * innovation;
  bias_radps = bias_radps + Vector3{gain[kBias], gain[kBias + 1], gain[kBias + 2]} * innovation;
}

void InertialKalman::update(int state, double innovation, double noise, double bias_gain, Correction& correction) {
  const double total = p[state][state] + noise, share = 1.0 / total;
  double gain[kStates];
  for (int i = 0; i < kStates; ++i) gain[i] = (i < kBias ? share : share * bias_gain) * p[state][i];
  correction = correction + Vector3{gain[0], gain[1], gain[2]} * innovation;
  take(state, gain, innovation, total);
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

void InertialKalman::pointed(double innovation, double noise, double heading_gain, double bias_gain) {
  const double total = p[kHeading][kHeading] + noise, share = bias_gain / total;
  double gain[kStates] = {};
  gain[kHeading] = heading_gain;
  for (int i = kBias; i < kStates; ++i) gain[i] = share * p[kHeading][i];
  take(kHeading, gain, innovation, total);
}

}  // namespace wayfuse
