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
      cloud_(static_cast<std::size_t>(settings.particles), motion_->columns()) {}

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
  const auto gained = gained_.get(cloud_.size());
  std::ranges::fill(gained, 0.0f);
  measurement.weigh(cloud_, gained);
  if (std::ranges::none_of(gained, [](float gain) { return std::isfinite(gain); })) return false;
  const auto weights = cloud_.log_weight();
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] += gained[i];
  cloud_.normalise();
  if (cloud_.effective_size() <= settings_.resample_below * static_cast<double>(cloud_.size())) {
    resampler_->resample(cloud_, random);
  }
  return true;
}

GaussianState ParticleFilter::estimate() const {
  const auto weights = cloud_.weights();  // the log weights are always normalised between calls
  const std::array<std::span<const float>, 4> columns = {cloud_.x_m(), cloud_.y_m(), cloud_.vx_mps(), cloud_.vy_mps()};
  const std::size_t dimensions = columns[2].empty() ? 2 : 4;
  std::array<double, 4> mean{};
  double sum = 0.0;
  for (const float weight : weights) sum += static_cast<double>(weight);
  for (std::size_t d = 0; d < dimensions; ++d) {
    for (std::size_t i = 0; i < weights.size(); ++i) mean[d] += static_cast<double>(weights[i]) * static_cast<double>(columns[d][i]);
    mean[d] /= sum;
  }
  GaussianState state{{mean[0], mean[1], mean[2], mean[3]}, {}};
  for (std::size_t row = 0; row < dimensions; ++row) {
    for (std::size_t column = 0; column <= row; ++column) {
      double product = 0.0;
      for (std::size_t i = 0; i < weights.size(); ++i) {
        product += static_cast<double>(weights[i]) * (static_cast<double>(columns[row][i]) - mean[row]) *
                   (static_cast<double>(columns[column][i]) - mean[column]);
      }
      state.covariance[row * 4 + column] = state.covariance[column * 4 + row] = product / sum;
    }
  }
  return state;
}

double ParticleFilter::radius_m(double share) const {
  const auto weights = cloud_.weights();
  const auto x_m = cloud_.x_m(), y_m = cloud_.y_m();
  double sum = 0.0, mean_x = 0.0, mean_y = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const auto weight = static_cast<double>(weights[i]);
    sum += weight;
    mean_x += weight * static_cast<double>(x_m[i]);
    mean_y += weight * static_cast<double>(y_m[i]);
  }
  const auto cx = static_cast<float>(mean_x / sum), cy = static_cast<float>(mean_y / sum);
  const auto squared_m2 = [&](std::size_t i) { return (x_m[i] - cx) * (x_m[i] - cx) + (y_m[i] - cy) * (y_m[i] - cy); };
  float farthest_m2 = 0.0f;
  for (std::size_t i = 0; i < weights.size(); ++i) farthest_m2 = std::max(farthest_m2, squared_m2(i));
  const float farthest_m = std::sqrt(farthest_m2);
  if (!(farthest_m > 0.0f) || !std::isfinite(farthest_m)) return 0.0;
  constexpr std::size_t kBins = 512;
  std::array<double, kBins + 1> held{};  // a histogram: no sort, no allocation, within 0.2 % of the farthest particle
  const float bins_per_m = static_cast<float>(kBins - 1) / farthest_m;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    held[static_cast<std::size_t>(std::sqrt(squared_m2(i)) * bins_per_m)] += static_cast<double>(weights[i]);
  }
  double reached = 0.0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    reached += held[bin] / sum;
    if (reached >= share) return static_cast<double>(farthest_m) * static_cast<double>(bin + 1) / kBins;
  }
  return static_cast<double>(farthest_m);
}

}  // namespace wayfuse
