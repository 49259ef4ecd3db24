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
  // Particle i owns those of the pointers u, u + 1, ... that lie below N times the weights up to and with it. How many is anyone's
  // guess, so nothing branches on it: each particle signs where its pointers begin (who owns none is signed over), and the newest
  // signature counts from there on. Weights are whole numbers of 2^-40, whose sums wait for nothing and round nowhere.
  constexpr int kBits = 40;
  const auto weights = cloud.weights();
  const auto ancestors = cloud.ancestors();
  const auto particles = static_cast<std::int64_t>(cloud.size());
  const std::int64_t rounding = (std::int64_t{1} << kBits) - 1 - static_cast<std::int64_t>(random.uniform() * 0x1p40);
  std::ranges::fill(ancestors, 0u);
  std::int64_t reached = 0, begins = 0;
  for (std::uint32_t i = 0; i < cloud.size() && begins < particles; ++i) {
    ancestors[static_cast<std::size_t>(begins)] = i;
    reached += static_cast<std::int64_t>(weights[i] * 0x1p40f);
    begins = (reached * particles + rounding) >> kBits;
  }
  if (begins < particles) ancestors[static_cast<std::size_t>(begins)] = 0;  // rounding ate the end: who owned the last one owns it
  std::uint32_t owner = 0;
  for (std::uint32_t& each : ancestors) each = owner = std::max(owner, each);
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
