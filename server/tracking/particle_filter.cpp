#include "server/tracking/particle_filter.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "server/tracking/noise.hpp"

namespace wayfuse {

ParticleFilter::ParticleFilter(const ParticleFilterSettings& settings, std::shared_ptr<const MotionModel> motion,
                               std::shared_ptr<const Resampler> resampler)
    : settings_(settings),
      motion_(std::move(motion)),
      resampler_(std::move(resampler)),
      cloud_(static_cast<std::size_t>(settings.particles), motion_->columns()),
      gained_(static_cast<std::size_t>(settings.particles)) {}

void ParticleFilter::start(const GaussianState& about, Random& random) {
  const auto scatter = [&](std::span<float> column, double mean, double variance) {
    const Noise noise(random);
    const double sigma = std::sqrt(std::max(0.0, variance));
    for (std::uint32_t i = 0; i < column.size(); ++i) {
      column[i] = static_cast<float>(mean + sigma * static_cast<double>(noise.normal(i).first));
    }
  };
  scatter(cloud_.x_m(), about.mean.x_m, about.covariance[0]);
  scatter(cloud_.y_m(), about.mean.y_m, about.covariance[5]);
  scatter(cloud_.vx_mps(), about.mean.vx_mps, about.covariance[10]);
  scatter(cloud_.vy_mps(), about.mean.vy_mps, about.covariance[15]);
  cloud_.level();
  motion_->start(cloud_, random);
  started_ = true;
}

void ParticleFilter::predict(const Motion& motion, Random& random) {
  assert(started_ && motion.dt_s > 0.0);
  motion_->propagate(cloud_, motion, random);
}

bool ParticleFilter::update(const MeasurementModel& measurement, Random& random) {
  assert(started_);
  std::ranges::fill(gained_, 0.0f);
  measurement.weigh(cloud_, gained_);
  if (std::ranges::none_of(gained_, [](float gain) { return std::isfinite(gain); })) return false;
  const auto weights = cloud_.log_weight();
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] += gained_[i];
  cloud_.normalise();
  if (cloud_.effective_size() <= settings_.resample_below * static_cast<double>(cloud_.size())) {
    resampler_->resample(cloud_, random);
  }
  return true;
}

GaussianState ParticleFilter::estimate() const {
  const auto weights = cloud_.log_weight();
  std::array<double, 4> mean{};
  std::array<std::span<const float>, 4> columns = {cloud_.x_m(), cloud_.y_m(), cloud_.vx_mps(), cloud_.vy_mps()};
  const std::size_t dimensions = columns[2].empty() ? 2 : 4;
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double weight = std::exp(static_cast<double>(weights[i]));
    sum += weight;
    for (std::size_t d = 0; d < dimensions; ++d) mean[d] += weight * static_cast<double>(columns[d][i]);
  }
  for (double& value : mean) value /= sum;
  GaussianState state{{mean[0], mean[1], mean[2], mean[3]}, {}};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double weight = std::exp(static_cast<double>(weights[i])) / sum;
    for (std::size_t row = 0; row < dimensions; ++row) {
      for (std::size_t column = 0; column <= row; ++column) {
        state.covariance[row * 4 + column] += weight * (static_cast<double>(columns[row][i]) - mean[row]) *
                                              (static_cast<double>(columns[column][i]) - mean[column]);
      }
    }
  }
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = row + 1; column < 4; ++column) state.covariance[row * 4 + column] = state.covariance[column * 4 + row];
  }
  return state;
}

double ParticleFilter::radius_m(double share) const {
  const State mean = estimate().mean;
  const auto weights = cloud_.log_weight();
  const auto distance = [&](std::size_t i) {
    return std::hypot(static_cast<double>(cloud_.x_m()[i]) - mean.x_m, static_cast<double>(cloud_.y_m()[i]) - mean.y_m);
  };
  double farthest = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) farthest = std::max(farthest, distance(i));
  constexpr std::size_t kBins = 512;
  std::array<double, kBins> held{};  // a histogram: no sort, no allocation, within 0.2 % of the farthest particle
  const double bins_per_m = farthest > 0.0 ? (kBins - 1) / farthest : 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    held[static_cast<std::size_t>(distance(i) * bins_per_m)] += std::exp(static_cast<double>(weights[i]));
  }
  double sum = 0.0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    sum += held[bin];
    if (sum >= share) return farthest * static_cast<double>(bin + 1) / kBins;
  }
  return farthest;
}

}  // namespace wayfuse
