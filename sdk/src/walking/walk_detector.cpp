#include "sdk/src/walking/walk_detector.hpp"

#include <algorithm>

namespace wayfuse {

// Steps wait in one unbroken run: a pause ends it.
void WalkDetector::remember(const Step& step) {
  if (step.interval_s == 0.0 || step.interval_s > settings_.pause_s) pending_count_ = 0;
  if (pending_count_ == StepBatch::kMost) {
    std::copy(pending_ + 1, pending_ + StepBatch::kMost, pending_);
    --pending_count_;
  }
  pending_[pending_count_++] = step;
}

StepBatch WalkDetector::feed(PhoneTime time, Vector3 acceleration) {
  const double dt_s = started_ ? seconds(time - time_) : 0.0;
  time_ = time;
  started_ = true;
  gate_.feed(settings_.gait, acceleration, dt_s);
  if (const auto step = peaks_.feed(time, norm(acceleration))) remember(*step);
  StepBatch batch;
  if (!gate_.walking || pending_count_ == 0) return batch;
  for (int i = 0; i < pending_count_; ++i) {
    if (seconds(time - pending_[i].time) <= settings_.remember_s) batch.steps[batch.count++] = pending_[i];
  }
  pending_count_ = 0;
  batch.confidence = 1.0 / (1.0 + std::exp(-gate_.log_odds));
  return batch;
}

}  // namespace wayfuse
