#include "sdk/src/walking/gait_gate.hpp"

#include <algorithm>
#include <numbers>

namespace wayfuse {
namespace {

constexpr double kGravity = 9.81;
constexpr double kSplit_hz = 3.0;
constexpr double kGravity_hz = 0.25;

double smoothing(double cutoff_hz, double dt_s) {
  const double x = 2.0 * std::numbers::pi * cutoff_hz * dt_s;
  return x / (1.0 + x);
}

}  // namespace

bool GaitGate::feed(const GaitGateSettings& settings, Vector3 acceleration, double dt_s) {
  const double length = norm(acceleration);
  if (!started_ || dt_s > 1.0) {
    *this = GaitGate{};
    first_ = second_ = length;
    slow_ = gravity_ = acceleration;
    started_ = true;
    return false;
  }
  const double split = smoothing(kSplit_hz, dt_s), slow = smoothing(kGravity_hz, dt_s);
  first_ += split * (length - first_);
  second_ += split * (first_ - second_);
  slow_ = slow_ + (acceleration - slow_) * slow;
  gravity_ = gravity_ + (slow_ - gravity_) * slow;
  high_square_ += (length - second_) * (length - second_);
  in_tick_ += 1.0;
  until_tick_s_ -= dt_s;
  if (until_tick_s_ > 0.0) return false;
  until_tick_s_ = std::max(until_tick_s_ + kTick_s, 0.5 * kTick_s);
  const double g = std::max(1.0, norm(gravity_));
  const double along = dot(acceleration, gravity_) / g;
  ring_[next_] = {second_, high_square_ / in_tick_, along, std::max(0.0, length * length - along * along), length, gravity_ * (1.0 / g)};
  high_square_ = in_tick_ = 0.0;
  next_ = (next_ + 1) % kWindow;
  filled_ = std::min(filled_ + 1, kWindow);
  if (++since_decision_ < 12 || filled_ < kLeastFilled) return false;
  since_decision_ = 0;
  measure();
  const GaitFeatures& f = features;
  const auto log_of = [](double v) { return std::log(std::clamp(v, 0.02, 50.0)); };
  double now = settings.constant + settings.log_swing * log_of(f.swing_mps2) + settings.log_sharpness * log_of(f.sharpness) +
               settings.log_uprightness * log_of(f.uprightness) + settings.periodicity * f.periodicity +
               settings.excess * std::clamp(f.excess_mps2, -1.0, 6.0) + settings.log_tilting * log_of(f.tilting_rad + 0.01);
  now = f.swing_mps2 < settings.still_mps2 ? -5.0 : std::clamp(now, -5.0, 5.0);
  log_odds = settings.memory * log_odds + (1.0 - settings.memory) * now;
  walking = walking ? log_odds > settings.end_log_odds : log_odds > settings.begin_log_odds;
  return true;
}

void GaitGate::measure() {
  const int count = filled_, oldest = filled_ < kWindow ? 0 : next_;
  double low[kWindow];
  double mean = 0.0, high = 0.0, along = 0.0, along_square = 0.0, across = 0.0, total = 0.0;
  for (int i = 0; i < count; ++i) {
    const Tick& tick = ring_[(oldest + i) % kWindow];  // oldest first
    low[i] = tick.low;
    mean += tick.low;
    high += tick.high_square;
    along += tick.along;
    along_square += tick.along * tick.along;
    across += tick.across_square;
    total += tick.total;
  }
  const double n = 1.0 / count;
  mean *= n;
  double square[kWindow + 1] = {};  // running sums of squares, for the normalisation
  for (int i = 0; i < count; ++i) {
    low[i] -= mean;
    square[i + 1] = square[i] + low[i] * low[i];
  }
  features.swing_mps2 = std::sqrt(square[count] * n);
  features.sharpness = std::sqrt(high * n) / std::max(0.02, features.swing_mps2);
  features.uprightness = std::sqrt(std::max(0.0, along_square * n - along * along * n * n) / std::max(1e-4, across * n));
  features.excess_mps2 = total * n - kGravity;
  features.periodicity = -1.0;
  for (int lag = kNewest; lag <= std::min(kOldest, count - kNewest); ++lag) {
    double sum = 0.0;
    for (int i = lag; i < count; ++i) sum += low[i] * low[i - lag];
    const double scale = std::sqrt((square[count] - square[lag]) * square[count - lag]);
    if (scale > 1e-6) features.periodicity = std::max(features.periodicity, sum / scale);
  }
  const Vector3 a = ring_[oldest].gravity, b = ring_[(oldest + count - 1) % kWindow].gravity;
  features.tilting_rad = std::atan2(norm(cross(a, b)), dot(a, b));
}

}  // namespace wayfuse
