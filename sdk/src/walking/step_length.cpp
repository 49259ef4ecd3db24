#include "sdk/src/walking/step_length.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse {

double weinberg_step_length_m(double swing_mps2, double k) {
  return std::clamp(k * std::sqrt(std::sqrt(std::max(0.0, swing_mps2))), 0.2, 1.3);
}

double StepLength::take(const StepLengthSettings& s, const Step& step) {
  if (step.interval_s > 0.25 && step.interval_s < 1.2) {
    const double now_hz = 1.0 / step.interval_s;
    cadence_hz = cadence_hz > 0.0 ? cadence_hz + 0.3 * (now_hz - cadence_hz) : now_hz;
  }
  const double swing = std::clamp(step.swing_mps2, 0.0, s.swing_most_mps2);
  const double cadence = cadence_hz > 0.0 ? cadence_hz : 1.9;
  const double length = s.weinberg_m * std::sqrt(std::sqrt(swing)) + s.constant_m + s.per_hertz_m * cadence + s.per_swing_m * swing;
  return std::clamp(scale * std::clamp(length, s.least_m, s.most_m), 0.2, 1.5);
}

void StepLength::walked(double length_m, double dx_m, double dy_m) {
  path_m_ += length_m;
  dx_m_ += dx_m;
  dy_m_ += dy_m;
}

// One measurement of the scale: true displacement over reckoned displacement, both ends uncertain. Scalar Kalman update.
void StepLength::taught(const StepLengthSettings& s, BuildingPoint fused, double sigma_m) {
  if (!std::isfinite(fused.x_m) || !std::isfinite(fused.y_m) || !(sigma_m > 0.0)) return;
  const double reckoned = std::hypot(dx_m_, dy_m_);
  const bool done = anchored_ && reckoned >= s.teach_m;
  if (done && reckoned >= s.straight * path_m_) {
    const double measured = std::hypot(fused.x_m - anchor_.x_m, fused.y_m - anchor_.y_m) / reckoned;
    const double noise = std::hypot(sigma_m, anchor_sigma_m_) / reckoned;
    const double before = scale_sigma * scale_sigma;
    // Steps are already scaled: the measurement is of the correction, about 1.
    const double gain = before / (before + noise * noise * scale * scale);
    if (std::abs(measured - 1.0) < 3.0 * std::hypot(noise, scale_sigma / scale)) {
      scale = std::clamp(scale * (1.0 + gain * (measured - 1.0)), 0.7, 1.4);
      scale_sigma = std::max(0.02, std::sqrt((1.0 - gain) * before));
    }
  }
  // A bend, or a stretch used up: begin again here.
  if (!anchored_ || done || (path_m_ > s.teach_m && reckoned < s.straight * path_m_)) {
    anchor_ = fused;
    anchor_sigma_m_ = sigma_m;
    anchored_ = true;
    path_m_ = dx_m_ = dy_m_ = 0.0;
  }
}

}  // namespace wayfuse
