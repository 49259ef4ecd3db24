#include "server/tracking/resamplers.hpp"

#include <algorithm>
#include <cmath>

#include "server/tracking/noise.hpp"

namespace wayfuse {
namespace {

double weight(const ParticleCloud& cloud, std::size_t i) { return static_cast<double>(cloud.weights()[i]); }

// Ancestors for `pointers` ascending positions in [0, 1), given by position(k), of the distribution share(i).
template <typename Share, typename Position>
void point_out(std::span<std::uint32_t> ancestors, std::size_t particles, const Share& share, const Position& position) {
  double reached = share(0);
  std::uint32_t i = 0;
  for (std::size_t k = 0; k < ancestors.size(); ++k) {
    while (position(k) >= reached && i + 1 < particles) reached += share(++i);
    ancestors[k] = i;
  }
}

// Ascending uniform order statistics one by one, without a sort: 1 - U^(1/n), then the same of what is left.
class SortedUniforms {
 public:
  SortedUniforms(std::size_t count, Random& random) : left_(count), random_(random) {}
  double next() {
    const double step = std::pow(1.0 - random_.uniform(), 1.0 / static_cast<double>(left_--));
    at_ = 1.0 - (1.0 - at_) * step;
    return at_;
  }

 private:
  std::size_t left_;
  double at_ = 0.0;
  Random& random_;
};

void draw_independently(std::span<std::uint32_t> ancestors, std::size_t particles, Random& random, const auto& share) {
  SortedUniforms uniforms(ancestors.size(), random);
  std::size_t drawn = 0;
  double position = 0.0;
  point_out(ancestors, particles, share, [&](std::size_t k) {
    for (; drawn <= k; ++drawn) position = uniforms.next();
    return position;
  });
}

}  // namespace

void MultinomialResampler::resample(ParticleCloud& cloud, Random& random) const {
  draw_independently(cloud.ancestors(), cloud.size(), random, [&](std::size_t i) { return weight(cloud, i); });
  cloud.take_ancestors();
}

void SystematicResampler::resample(ParticleCloud& cloud, Random& random) const {
  // Particle i is pointed at by those of the pointers u, u + 1, ... that lie below N times the weights up to and with it.
  const auto weights = cloud.weights();
  const auto ancestors = cloud.ancestors();
  const auto particles = static_cast<double>(cloud.size());
  const double first = random.uniform();
  double reached = 0.0;
  std::size_t pointed = 0;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    reached += particles * static_cast<double>(weights[i]);
    const double passed = std::max(0.0, reached - first);
    auto below = static_cast<std::size_t>(passed);  // rounded up without a call into the library
    below += static_cast<double>(below) < passed;
    for (const std::size_t end = std::min(below, cloud.size()); pointed < end; ++pointed) ancestors[pointed] = i;
  }
  const std::uint32_t last = pointed > 0 ? ancestors[pointed - 1] : 0;
  std::fill(ancestors.begin() + static_cast<std::ptrdiff_t>(pointed), ancestors.end(), last);  // rounding ate the end
  cloud.take_ancestors();
}

void ResidualResampler::resample(ParticleCloud& cloud, Random& random) const {
  const auto particles = static_cast<double>(cloud.size());
  const auto copies = [&](std::size_t i) { return std::floor(particles * weight(cloud, i) + 1e-6); };  // float log weights
  auto ancestors = cloud.ancestors();
  std::size_t sure = 0;
  double left = 0.0;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    for (double copy = copies(i); copy > 0.0 && sure < cloud.size(); --copy) ancestors[sure++] = i;
    left += std::max(0.0, particles * weight(cloud, i) - copies(i));
  }
  if (sure < cloud.size()) {
    draw_independently(ancestors.subspan(sure), cloud.size(), random, [&](std::size_t i) {
      return left > 0.0 ? std::max(0.0, particles * weight(cloud, i) - copies(i)) / left : 1.0 / particles;
    });
  }
  cloud.take_ancestors();
}

void PerturbingResampler::resample(ParticleCloud& cloud, Random& random) const {
  SystematicResampler{}.resample(cloud, random);
  const Noise choice(random);
  const Noise offset(random);
  const auto share = static_cast<float>(settings_.share);
  const auto sigma_m = static_cast<float>(settings_.sigma_m);
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (choice.uniform(i).second >= share) continue;
    const Noise::Pair n = offset.normal(i);
    cloud.x_m()[i] += sigma_m * n.first;
    cloud.y_m()[i] += sigma_m * n.second;
  }
}

}  // namespace wayfuse
