#pragma once

#include "sdk/src/walking/gait_gate.hpp"
#include "sdk/src/walking/step_detector.hpp"

namespace wayfuse {

/// Steps that came to be counted with one reading. When walking is recognised, those of the seconds before come together, each
/// with its own time.
struct StepBatch {
  static constexpr int kMost = 24;
  Step steps[kMost];
  int count = 0;
  double confidence = 0.0;   ///< 0..1 that this is walking
};

struct WalkDetectorSettings {
  StepDetectorSettings steps;
  GaitGateSettings gait;
  double pause_s = 1.1;      ///< a longer interval ends the run that waits to be recognised
  double remember_s = 10.0;  ///< how far back steps are counted once walking is recognised
};

/// Counts peaks of the acceleration as steps while the gait gate says that this is walking. Needs the accelerometer alone.
///
/// Causal. Copyable state; thread: confined to its owner.
class WalkDetector {
 public:
  explicit WalkDetector(const WalkDetectorSettings& settings = {}) : settings_(settings), peaks_(settings.steps) {}

  /// Times strictly ascending; `acceleration_mps2` finite.
  StepBatch feed(PhoneTime time, Vector3 acceleration_mps2);
  bool walking() const { return gate_.walking; }
  const GaitGate& gait() const { return gate_; }

 private:
  void remember(const Step& step);

  WalkDetectorSettings settings_;
  StepDetector peaks_;
  GaitGate gate_;
  Step pending_[StepBatch::kMost];
  int pending_count_ = 0;
  PhoneTime time_;
  bool started_ = false;
};

}  // namespace wayfuse
