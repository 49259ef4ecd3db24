#include "server/tracking/range_measurement.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse {
namespace {
constexpr double kLeastDistanceM = 0.1;  // at a transmitter itself a distance has no direction
constexpr float kMostSquaredSigmas = 16.0f;
}  // namespace

void RangeMeasurement::add(const Range& range) {
  if (count_ < ranges_.size()) ranges_[count_++] = range;
}

void RangeMeasurement::weigh(const ParticleCloud& cloud, std::span<float> log_weight) const {
  const auto x_m = cloud.x_m(), y_m = cloud.y_m();
  for (const Range& range : ranges()) {
    const auto ax = static_cast<float>(range.x_m), ay = static_cast<float>(range.y_m);
    const auto z = static_cast<float>(range.distance_m);
    const auto precision = static_cast<float>(1.0 / (range.sigma_m * range.sigma_m));
    for (std::size_t i = 0; i < x_m.size(); ++i) {
      const float dx = x_m[i] - ax, dy = y_m[i] - ay;
      const float error = std::sqrt(dx * dx + dy * dy) - z;
      log_weight[i] -= 0.5f * std::min(error * error * precision, kMostSquaredSigmas);
    }
  }
}

void RangeMeasurement::residual(const State& state, std::span<double> out) const {
  for (std::size_t i = 0; i < count_; ++i) {
    out[i] = ranges_[i].distance_m - std::hypot(state.x_m - ranges_[i].x_m, state.y_m - ranges_[i].y_m);
  }
}

void RangeMeasurement::jacobian(const State& state, std::span<double> out) const {
  std::ranges::fill(out.first(4 * count_), 0.0);
  for (std::size_t i = 0; i < count_; ++i) {
    const double dx = state.x_m - ranges_[i].x_m, dy = state.y_m - ranges_[i].y_m;
    const double d_m = std::max(std::hypot(dx, dy), kLeastDistanceM);
    out[4 * i] = dx / d_m;
    out[4 * i + 1] = dy / d_m;
  }
}

void RangeMeasurement::variance(std::span<double> out) const {
  for (std::size_t i = 0; i < count_; ++i) out[i] = ranges_[i].sigma_m * ranges_[i].sigma_m;
}

}  // namespace wayfuse
