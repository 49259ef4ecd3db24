#pragma once

#include "sdk/src/attitude/sample_gate.hpp"

namespace wayfuse {

struct MadgwickSettings {
  double beta_radps = 0.12;   ///< gradient step; larger follows gravity and compass faster
};

/// The gradient-descent filter of Madgwick et al. (2011), written from the publication: the yardstick most phones know.
///
/// For measuring only. Thread: confined to its owner.
class MadgwickHeading final : public HeadingEstimator {
 public:
  explicit MadgwickHeading(const MadgwickSettings& settings = {}) : settings_(settings) {}
  void feed(const MargSample& sample) override;
  std::optional<Attitude> attitude() const override;
  void expect(const MagneticField& field) override { expected_ = field; }
  SampleCounts counts() const override { return gate_.counts; }

 private:
  void start();
  Quaternion descent() const;

  MadgwickSettings settings_;
  SampleGate gate_;
  MagneticField expected_;
  Quaternion q_;                       // body -> east, north, up
  std::optional<Vector3> up_, field_;  // newest unit vectors, body
  Vector3 rate_;
  PhoneTime time_;
  bool started_ = false;
};

}  // namespace wayfuse
