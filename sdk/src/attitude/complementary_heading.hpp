#pragma once

#include "sdk/src/attitude/sample_gate.hpp"

namespace wayfuse {

struct ComplementarySettings {
  double magnetic_weight = 0.7;    ///< W of [P1 eq. 10], 0..1: larger follows the compass, smaller the gyroscope
  double tilt_time_s = 2.0;        ///< how long gravity is averaged; larger shakes less and forgets gyro bias slower
  double gap_s = 1.0;              ///< longer silence of the gyroscope: the turn in it is unknown, start again
  double heading_sigma_rad = 0.26; ///< stated for the blended heading (15 degrees)
};

/// [P1]'s complementary filter, made valid at any tilt.
///
/// Differs from [P1 eqs. 4-5]: gravity is averaged in the inertial frame, where the gyroscope has taken the phone's own turning
/// out, and tilt is a quaternion. The blend [P1 eq. 10] turns by W times the wrapped difference: on the circle.
/// Without a magnetometer the heading is relative (kArbitrary) and its sigma grows. Thread: confined to its owner.
class ComplementaryHeading final : public HeadingEstimator {
 public:
  explicit ComplementaryHeading(const ComplementarySettings& settings = {}) : settings_(settings) {}

  void feed(const MargSample& sample) override;
  std::optional<Attitude> attitude() const override;
  void expect(const MagneticField& field) override { expected_ = field; }
  SampleCounts counts() const override { return gate_.counts; }

 private:
  void turn(const SampleGate::Passed& turn_rate);
  void level(const SampleGate::Passed& acceleration);
  void point(Vector3 field_ut);

  ComplementarySettings settings_;
  SampleGate gate_;
  MagneticField expected_;
  Quaternion q_;
  Vector3 gravity_enu_{0, 0, 0};   // running mean of R a, m/s2
  Vector3 turn_rate_radps_;
  PhoneTime time_;
  double averaged_s_ = 0.0;
  double drift_s_ = 0.0;           // since the compass last spoke
  bool level_ = false;
  bool pointed_ = false;
};

/// [P1]'s filter exactly as printed: Euler angles from the raw accelerometer by arcsine (eqs. 4-5), eqs. 6-10.
///
/// For comparison only: valid near level and without acceleration. Thread: confined to its owner.
class PrintedComplementaryHeading final : public HeadingEstimator {
 public:
  explicit PrintedComplementaryHeading(const ComplementarySettings& settings = {}) : settings_(settings) {}

  void feed(const MargSample& sample) override;
  std::optional<Attitude> attitude() const override;
  void expect(const MagneticField& field) override { expected_ = field; }
  SampleCounts counts() const override { return gate_.counts; }

 private:
  ComplementarySettings settings_;
  SampleGate gate_;
  MagneticField expected_;
  Vector3 turn_rate_radps_;
  PhoneTime time_;
  double roll_rad_ = 0.0;     // about y, of the x axis above the horizon
  double pitch_rad_ = 0.0;    // about x, of the y axis above the horizon
  double heading_rad_ = 0.0;  // of y, from east
  bool level_ = false;
  bool pointed_ = false;
};

/// The compass of [P2] and [P5]: heading of every sample alone, from gravity and the magnetic field. No gyroscope.
///
/// "Phone held steady" [P2]: any acceleration tilts it. Thread: confined to its owner.
class CompassHeading final : public HeadingEstimator {
 public:
  void feed(const MargSample& sample) override;
  std::optional<Attitude> attitude() const override;
  void expect(const MagneticField& field) override { expected_ = field; }
  SampleCounts counts() const override { return gate_.counts; }

 private:
  SampleGate gate_;
  MagneticField expected_;
  std::optional<Vector3> acceleration_;
  std::optional<Vector3> field_;
  Vector3 turn_rate_radps_;
  PhoneTime time_;
};

}  // namespace wayfuse
