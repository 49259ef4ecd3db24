#pragma once

#include "sdk/src/attitude/inertial_kalman.hpp"
#include "sdk/src/attitude/magnetic_field.hpp"
#include "sdk/src/attitude/sample_gate.hpp"

namespace wayfuse {

struct BlockHeadingSettings {
  double block_s = 0.1;             ///< corrections come this often; larger costs less and answers later
  double block_samples = 8.0;       ///< but not before so many gyroscope readings,
  double block_most_s = 0.25;       ///< unless so much time has passed
  double gap_s = 0.5;               ///< longer silence of the gyroscope: gravity and compass carry on alone, and it starts anew
  double alone_s = 0.3;             ///< smoothing of gravity and compass meanwhile,
  double alone_sigma_rad = 0.35;    ///< and what their heading is worth (20 degrees)
  double sensor_delay_s = 0.004;      ///< group delay of the gyroscope's own low-pass: the output is turned ahead by so much
  double rest_rate_radps = 0.035;   ///< deviation from the running mean below which it may be rest (2 degrees a second)
  double rest_force_mps2 = 0.5;
  double rest_after_s = 1.0;
  double switch_sigma_rad = 0.35;   ///< heading doubted so much after a better supported field took over (20 degrees)
  double expected_support_s = 2.0;  ///< how long another field must last before it replaces the one the building expects
  InertialKalmanSettings inertial;
  HardIronSettings hard_iron;
  MagneticHeadingSettings magnetic;
};

/// Everything a BlockHeading knows: copy it to save it, assign it to restore; the same samples then give the same bits.
struct BlockHeadingState {
  SampleGate gate;
  Quaternion q;                  ///< body -> inertial frame: level, heading free
  Vector3 rate_radps;            ///< newest, as measured
  PhoneTime time, rate_time;     ///< of the newest reading of any kind, of the newest turn rate
  Matrix3 rotation = {};         ///< of q, while fresh
  bool rotation_fresh = false;
  bool level = false;

  // Sums over the running block.
  double block_s = 0.0;
  double rates = 0.0, square_rate = 0.0, forces = 0.0, square_force = 0.0;
  Vector3 rate_sum, force_sum, inertial_force_sum;
  MagneticSums magnetic;

  InertialKalman kalman;
  HardIron hard_iron;
  MagneticHeading compass;
  MagneticField expected;

  Vector3 slow_rate, slow_force;   ///< running means for the rest detector
  double still_s = 0.0;
  bool at_rest = false;
  double shake = 0.0;              ///< running mean square of |force| - g over about a second, (m/s2)^2
};

/// The project's own causal MARG filter, "block_marg" in the catalogue. Without a magnetometer its heading is relative; where
/// the gyroscope is missing or falls silent, smoothed gravity and compass carry on with a large sigma.
///
/// Every sample: the gyroscope turns a quaternion (trapezoid and coning, no trigonometry), sums are kept. Every block: an
/// error-state Kalman filter corrects tilt and bias from "velocity = 0" and from rest; the compass turns the heading only, apart
/// from the tilt. Thread: confined to its owner.
class BlockHeading final : public HeadingEstimator {
 public:
  explicit BlockHeading(const BlockHeadingSettings& settings = {});

  void feed(const MargSample& sample) override;
  std::optional<Attitude> attitude() const override;
  void expect(const MagneticField& field) override;
  SampleCounts counts() const override { return state_.gate.counts; }

  const BlockHeadingState& state() const { return state_; }
  void restore(const BlockHeadingState& state) { state_ = state; }
  std::optional<SensorCalibration> calibration() const override;
  void start_with(const SensorCalibration& calibration) override;

 private:
  bool silent(PhoneTime now) const;
  void start_anew();
  void turn(Vector3 rate_radps, double dt_s);
  void level();
  void sense_force(Vector3 force_mps2);
  void sense_field(Vector3 field_ut);
  void level_alone(Vector3 force_mps2, double dt_s);
  void point_alone(double dt_s);
  void close_block();
  void clear_block();
  const Matrix3& rotation();
  void detect_rest(double dt_s);
  void follow_field(double dt_s);

  BlockHeadingSettings settings_;
  BlockHeadingState state_;
};

}  // namespace wayfuse
