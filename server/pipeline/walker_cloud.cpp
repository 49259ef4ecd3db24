#include "server/pipeline/walker_cloud.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "server/tracking/noise.hpp"
#include "server/tracking/particle_kernels.hpp"

namespace wayfuse {
namespace {

constexpr float kOutsidePenalty = 8.0f;      // log weight: a step through a wall is nearly impossible
constexpr float kAgree = 6.0f;                // log-likelihood below the best walker's: farther off is another place
constexpr float kLeastShare = 1e-12f;         // of the best walker's likelihood
constexpr double kLeastLikelihood = 1e-9;
constexpr float kJitter_m = 0.15f;           // keeps copies of one particle apart
constexpr float kStrideJitter = 0.004f;
constexpr float kStraySigma = 0.25f;         // of a stride far from the phone's
constexpr float kShortestStride = 0.5f, kLongestStride = 1.6f;
constexpr double kResampleBelow = 0.5;       // of the particles, effective size
constexpr int kFirstScans = 6;
constexpr double kRenewedAtFirst = 0.05;
constexpr std::size_t kAtOnce = 256;          // walkers worked on together, a multiple of 16

}  // namespace

PartDescription walkers_description() {
  const WalkerSettings standard;
  return {"filter", "walkers", "walkers with a compass error and stride of their own inside the walkable area, weighed by a field; a whole tracker",
          {{"particles", static_cast<double>(standard.particles), 10, 100000, "walkers; the error falls slowly, the cost grows with it", "-", true},
           {"decorrelation_s", standard.decorrelation_s, 0.1, 100,
            "memory of a scan's error: the next one, s later, repeats exp(-s / this) of it; larger trusts scans less", "-"},
           {"outlier", standard.outlier, 0, 1, "likelihood no walker falls below, against the best one's; larger forgives wrong scans", "-"},
           {"renewed", standard.renewed, 0, 0.5, "share drawn anew from each scan; larger finds back sooner and blurs more", "-"},
           {"heading_sigma_rad", standard.heading_sigma_rad, 0, 3.2, "compass error of a fresh walker; larger turns more freely", "-"},
           {"heading_walk_rad_rts", standard.heading_walk_rad_rts, 0, 1, "its random walk per root second", "-"},
           {"stride_sigma", standard.stride_sigma, 0, 0.5, "stride of a fresh walker against the phone's, as a share", "-"},
           {"stray_strides", standard.stray_strides, 0, 1, "share of fresh walkers with a stride far from the phone's; larger adapts sooner", "-"},
           {"step_sigma_rtm", standard.step_sigma_rtm, 0, 5, "blur per root metre walked", "-"},
           {"walkable", 1, 0, 1, "0: walls and shops are not looked at", "-", true},
           {"second_opinion", 1, 0, 1, "0: a track that a scan contradicts gets no rival", "-", true},
           {"floor_memory", standard.floor_memory, 0, 1, "share of the floor belief a scan keeps; smaller changes floors sooner", "-"}}};
}

WalkerSettings walker_settings(const PartSettings& s) {
  WalkerSettings settings;
  settings.particles = s.count("particles");
  settings.decorrelation_s = s["decorrelation_s"];
  settings.outlier = s["outlier"];
  settings.renewed = s["renewed"];
  settings.heading_sigma_rad = s["heading_sigma_rad"];
  settings.heading_walk_rad_rts = s["heading_walk_rad_rts"];
  settings.stride_sigma = s["stride_sigma"];
  settings.stray_strides = s["stray_strides"];
  settings.step_sigma_rtm = s["step_sigma_rtm"];
  settings.walkable = s.on("walkable");
  settings.second_opinion = s.on("second_opinion");
  settings.floor_memory = s["floor_memory"];
  return settings;
}

WalkerCloud::WalkerCloud(const WalkerSettings& settings)
    : settings_(settings),
      cloud_(static_cast<std::size_t>(settings.particles), ParticleCloud::kBias | ParticleCloud::kScale | ParticleCloud::kEcho | ParticleCloud::kLogsOnly) {}

// Compass error and stride of fresh particles, which have heard no scan; then each is carried on as it would have walked.
void WalkerCloud::scatter(std::size_t count, std::size_t offset, BuildingPoint carried, const CompassPrior& compass, Random& random) {
  const auto sigma = static_cast<float>(settings_.heading_sigma_rad), known = static_cast<float>(compass.known_rad);
  const auto stride_sigma = static_cast<float>(settings_.stride_sigma), strays = static_cast<float>(settings_.stray_strides);
  const auto dx = static_cast<float>(carried.x_m), dy = static_cast<float>(carried.y_m);
  const Noise columns(random), directions(random);
  const auto x = cloud_.x_m(), y = cloud_.y_m(), bias = cloud_.heading_bias_rad(), scale = cloud_.stride_scale(), said = cloud_.said();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = one_of(count, k, offset);
    said[i] = 0.0f;
    const auto number = static_cast<std::uint32_t>(i);
    const Noise::Pair n = columns.normal(number);
    const auto u = directions.uniform(number);
    bias[i] = compass.lost ? 2.0f * std::numbers::pi_v<float> * u.second : known + sigma * n.first;
    scale[i] = std::clamp(1.0f + (u.first < strays ? kStraySigma : stride_sigma) * n.second, kShortestStride, kLongestStride);
    const CosineAndSine way = cosine_and_sine(bias[i]);
    const float c = scale[i] * way.cosine, s = scale[i] * way.sine;
    x[i] += c * dx - s * dy;
    y[i] += s * dx + c * dy;
  }
}

void WalkerCloud::start_about(BuildingPoint point, double sigma_m, const CompassPrior& compass, Random& random) {
  const Noise noise(random);
  for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
    const Noise::Pair n = noise.normal(i);
    cloud_.x_m()[i] = static_cast<float>(point.x_m + sigma_m * static_cast<double>(n.first));
    cloud_.y_m()[i] = static_cast<float>(point.y_m + sigma_m * static_cast<double>(n.second));
  }
  std::ranges::fill(cloud_.log_weight(), -std::log(static_cast<float>(cloud_.size())));
  scatter(cloud_.size(), 0, {}, compass, random);
  started_ = true;
  scans_ = 0;
}

void WalkerCloud::start_from(Locator& locator, FloorOrdinal floor, BuildingPoint carried, const CompassPrior& compass, Random& random) {
  if (!locator.draw(floor, random, cloud_.x_m(), cloud_.y_m())) return;
  std::ranges::fill(cloud_.log_weight(), -std::log(static_cast<float>(cloud_.size())));
  scatter(cloud_.size(), 0, carried, compass, random);
  started_ = true;
  scans_ = 1;
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    if (!open(cloud_.x_m()[i], cloud_.y_m()[i])) cloud_.log_weight()[i] -= kOutsidePenalty;
  }
  settle(random);
}

void WalkerCloud::turn_about(const CompassPrior& compass, Random& random) { scatter(cloud_.size(), 0, {}, compass, random); }

void WalkerCloud::walk(double dx_m, double dy_m, double sigma_m, double on_foot_s, Random& random) {
  on_foot_s_ += on_foot_s;
  if (sigma_m == 0.0) return;
  const auto x = cloud_.x_m(), y = cloud_.y_m();
  kernels::walk_turned(x.data(), y.data(), cloud_.heading_bias_rad().data(), cloud_.stride_scale().data(), cloud_.padded_size(),
                       static_cast<float>(dx_m), static_cast<float>(dy_m), static_cast<float>(sigma_m), random.bits());
  if (plan_) {
    const auto weight = cloud_.log_weight();
    for (std::size_t i = 0; i < cloud_.size(); ++i) {
      if (!plan_->open(x[i], y[i])) weight[i] -= kOutsidePenalty;
    }
  }
  settle(random);
}

// Normalised weights, renewed when too few particles carry them. A cloud wholly off the map starts over from equal weights.
void WalkerCloud::settle(Random& random) {
  cloud_.normalise();
  if (cloud_.effective_size() < kResampleBelow * static_cast<double>(cloud_.size())) resample(random);
}

void WalkerCloud::resample(Random& random) {
  const auto weight = cloud_.log_weight();
  const auto size = static_cast<double>(cloud_.size());
  const double offset = random.uniform() / size;
  const auto ancestors = cloud_.ancestors();
  double cumulated = std::exp(static_cast<double>(weight[0]));
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
    const double target = offset + static_cast<double>(i) / size;
    while (cumulated < target && at + 1 < cloud_.size()) cumulated += std::exp(static_cast<double>(weight[++at]));
    ancestors[i] = at;
  }
  cloud_.take_ancestors();
  if (on_foot_s_ == 0.0) return;  // at rest copies may lie on one another: they say where the phone is, not where it goes
  const auto bias_sigma = static_cast<float>(settings_.heading_walk_rad_rts * std::sqrt(on_foot_s_));
  on_foot_s_ = 0.0;
  const Noise place(random), column(random);
  const auto x = cloud_.x_m(), y = cloud_.y_m(), bias = cloud_.heading_bias_rad(), scale = cloud_.stride_scale();
  for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
    const Noise::Pair p = place.normal(i), q = column.normal(i);
    const float moved_x = x[i] + kJitter_m * p.first, moved_y = y[i] + kJitter_m * p.second;
    if (open(moved_x, moved_y)) x[i] = moved_x, y[i] = moved_y;
    bias[i] += bias_sigma * q.first;
    scale[i] += kStrideJitter * q.second;
  }
}

// Where the walkers from `begin` on were before `carried` was walked.
void WalkerCloud::walked_back(std::size_t begin, BuildingPoint carried, std::span<float> x_then_m, std::span<float> y_then_m) const {
  const auto dx = static_cast<float>(carried.x_m), dy = static_cast<float>(carried.y_m);
  const auto x = cloud_.x_m(), y = cloud_.y_m(), bias = cloud_.heading_bias_rad(), scale = cloud_.stride_scale();
  for (std::size_t k = 0; k < x_then_m.size(); ++k) {
    const std::size_t i = begin + k;
    const CosineAndSine way = cosine_and_sine(bias[i]);
    const float c = scale[i] * way.cosine, s = scale[i] * way.sine;
    x_then_m[k] = x[i] - (c * dx - s * dy);
    y_then_m[k] = y[i] - (s * dx + c * dy);
  }
}

WalkerCloud::Hearing WalkerCloud::weigh(const Locator& locator, FloorOrdinal floor, BuildingPoint carried, double echo) {
  ++scans_;
  const auto gained = cloud_.scratch();  // log-likelihood of the scan
  std::ranges::fill(gained, 0.0f);
  std::array<float, kAtOnce> x_then_m, y_then_m;  // walkers when the scan was heard, some at a time
  for (std::size_t begin = 0; begin < cloud_.size(); begin += x_then_m.size()) {
    const std::size_t count = std::min(x_then_m.size(), cloud_.size() - begin);
    walked_back(begin, carried, {x_then_m.data(), count}, {y_then_m.data(), count});
    locator.add_log_likelihood({x_then_m.data(), count}, {y_then_m.data(), count}, floor, gained.subspan(begin, count));
  }
  float best = -INFINITY;
  for (const float each : gained) best = std::isfinite(each) ? std::max(best, each) : best;
  if (!std::isfinite(best)) return {};
  double agree = 0.0, likelihood = 0.0;
  const auto repeated = static_cast<float>(echo), outlier = static_cast<float>(settings_.outlier);
  const auto log_weight = cloud_.log_weight(), said = cloud_.said();
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    if (gained[i] > best - kAgree) {
      const double mass = std::exp(static_cast<double>(log_weight[i]));
      agree += mass;
      likelihood += mass * std::exp(static_cast<double>(gained[i] - best));
    }
    // Bounded: a walker that fits nowhere must not be owed infinitely much by the next scan. NaN counts as the least.
    const float says = std::log(std::min(1.0f + outlier, std::max(kLeastShare, std::exp(gained[i] - best) + outlier)));
    log_weight[i] += (says - repeated * said[i]) / (1.0f + repeated);
    said[i] = says;
  }
  cloud_.normalise();
  return {agree, static_cast<double>(best) + std::log(std::max(likelihood, kLeastLikelihood))};
}

double WalkerCloud::renewed() const {
  return settings_.renewed > 0.0 && scans_ <= kFirstScans ? std::max(kRenewedAtFirst, settings_.renewed) : settings_.renewed;
}

// Some particles begin again where the scan says. They weigh as much as an average one.
void WalkerCloud::renew(double share, Locator& locator, FloorOrdinal floor, BuildingPoint carried, const CompassPrior& compass,
                        Random& random) {
  const auto count = static_cast<std::size_t>(share * static_cast<double>(cloud_.size()));
  if (count == 0) return;
  // Walkers in a row descend from one ancestor: whoever is renewed stands evenly among them all.
  const std::size_t offset = random.below(cloud_.size());
  const auto x_m = cloud_.scratch().first(count), y_m = cloud_.scratch().subspan(count, count);
  if (!locator.draw(floor, random, x_m, y_m)) return;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = one_of(count, k, offset);
    cloud_.x_m()[i] = x_m[k];
    cloud_.y_m()[i] = y_m[k];
  }
  // They come in at an average weight, whatever the scan says of them: what it said of an average walker is to be taken back.
  const auto said = cloud_.said();
  const float average = std::accumulate(said.begin(), said.end(), 0.0f) / static_cast<float>(said.size());
  scatter(count, offset, carried, compass, random);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = one_of(count, k, offset);
    said[i] = average;
    cloud_.log_weight()[i] = -std::log(static_cast<float>(cloud_.size()));
    if (!open(cloud_.x_m()[i], cloud_.y_m()[i])) cloud_.log_weight()[i] -= kOutsidePenalty;
  }
}

void WalkerCloud::weigh(BuildingPoint point, double sigma_m) {
  const auto weight = cloud_.log_weight();
  const auto precision = static_cast<float>(1.0 / (sigma_m * sigma_m));
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const float dx = cloud_.x_m()[i] - static_cast<float>(point.x_m), dy = cloud_.y_m()[i] - static_cast<float>(point.y_m);
    weight[i] -= 0.5f * precision * (dx * dx + dy * dy);
  }
}

// In one pass, about the first walker: sums of squares about a far origin would lose the digits they are about.
WalkerCloud::Spread WalkerCloud::spread() const {
  const auto x = cloud_.x_m(), y = cloud_.y_m(), log_weight = cloud_.log_weight();
  std::array<float, kAtOnce> weight;
  double sum = 0.0, sx = 0.0, sy = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t begin = 0; begin < cloud_.size(); begin += kAtOnce) {
    kernels::exponentials(log_weight.data() + begin, std::min(kAtOnce, cloud_.padded_size() - begin), 0.0f, weight.data());
    for (std::size_t i = begin; i < std::min(begin + kAtOnce, cloud_.size()); ++i) {
      const double w = static_cast<double>(weight[i - begin]);
      const double dx = static_cast<double>(x[i] - x[0]), dy = static_cast<double>(y[i] - y[0]);
      const double wx = w * dx, wy = w * dy;
      sum += w, sx += wx, sy += wy, xx += wx * dx, xy += wx * dy, yy += wy * dy;
    }
  }
  const double mx = sx / sum, my = sy / sum;
  return {{static_cast<double>(x[0]) + mx, static_cast<double>(y[0]) + my},
          {std::max(0.0, xx / sum - mx * mx), xy / sum - mx * my, std::max(0.0, yy / sum - my * my)}};
}

}  // namespace wayfuse
