#include "server/locating/level_blocks.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/locating/level_blocks.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a vector unit
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace wayfuse::match::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using F = hn::Vec<Floats>;
constexpr std::size_t kBlock = LevelBlocks::kBlock;

void AddProducts(const std::uint32_t* HWY_RESTRICT start, const float* HWY_RESTRICT values, std::size_t blocks, float value,
                 float* HWY_RESTRICT products) {
  const Floats d;
  const F v = hn::Set(d, value);
  for (std::size_t b = 0; b < blocks; ++b) {
    float* HWY_RESTRICT to = products + start[b];
    const float* HWY_RESTRICT from = values + b * kBlock;
    for (std::size_t i = 0; i < kBlock; i += hn::Lanes(d)) {
      hn::StoreU(hn::Add(hn::LoadU(d, to + i), hn::Mul(v, hn::LoadU(d, from + i))), d, to + i);
    }
  }
}

void AddOverlapsAndProducts(const std::uint32_t* HWY_RESTRICT start, const float* HWY_RESTRICT values, std::size_t blocks,
                            float value, float* HWY_RESTRICT overlaps, float* HWY_RESTRICT products) {
  const Floats d;
  const F v = hn::Set(d, value), size = hn::Abs(v);
  for (std::size_t b = 0; b < blocks; ++b) {
    float* HWY_RESTRICT over = overlaps + start[b];
    float* HWY_RESTRICT product = products + start[b];
    const float* HWY_RESTRICT from = values + b * kBlock;
    for (std::size_t i = 0; i < kBlock; i += hn::Lanes(d)) {
      const F level = hn::LoadU(d, from + i);
      const F both = hn::Mul(v, level);
      const F common = hn::IfThenElseZero(hn::Gt(both, hn::Zero(d)), hn::Min(size, hn::Abs(level)));
      hn::StoreU(hn::Add(hn::LoadU(d, over + i), common), d, over + i);
      hn::StoreU(hn::Add(hn::LoadU(d, product + i), both), d, product + i);
    }
  }
}

void LeastFromShared(const float* HWY_RESTRICT own, float all, const float* HWY_RESTRICT shared, const std::uint8_t* HWY_RESTRICT touched,
                     std::size_t blocks, float* HWY_RESTRICT least) {
  const Floats d;
  const F everything = hn::Set(d, all), two = hn::Set(d, 2.0f);
  for (std::size_t b = 0; b < blocks; ++b) {
    if (!touched[b]) continue;
    F lowest = hn::Set(d, std::numeric_limits<float>::infinity());
    for (std::size_t i = b * kBlock; i < (b + 1) * kBlock; i += hn::Lanes(d)) {
      lowest = hn::Min(lowest, hn::Sub(hn::Add(hn::LoadU(d, own + i), everything), hn::Mul(two, hn::LoadU(d, shared + i))));
    }
    least[b] = hn::GetLane(hn::MinOfLanes(d, lowest));
  }
}

void SimilarityDistances(float total, const float* HWY_RESTRICT totals, const float* HWY_RESTRICT overlaps, std::size_t padded,
                         float* HWY_RESTRICT sorensen, float norm, const float* HWY_RESTRICT norms,
                         const float* HWY_RESTRICT products, float* HWY_RESTRICT cosine) {
  const Floats d;
  const F one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f), t = hn::Set(d, total), n = hn::Set(d, norm);
  for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
    const F shared = hn::Div(hn::Mul(two, hn::LoadU(d, overlaps + i)), hn::Add(t, hn::LoadU(d, totals + i)));
    const F angle = hn::Div(hn::LoadU(d, products + i), hn::Mul(n, hn::LoadU(d, norms + i)));
    hn::StoreU(hn::Sub(one, shared), d, sorensen + i);
    hn::StoreU(hn::Sub(one, angle), d, cosine + i);
  }
}

}  // namespace wayfuse::match::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wayfuse {
namespace match {
HWY_EXPORT(AddProducts);
HWY_EXPORT(AddOverlapsAndProducts);
HWY_EXPORT(LeastFromShared);
HWY_EXPORT(SimilarityDistances);
}  // namespace match

namespace {

// Bits of a 16 bit number spread to every second place.
std::uint32_t spread(std::uint32_t x) {
  x = (x | (x << 8)) & 0x00ff00ffu;
  x = (x | (x << 4)) & 0x0f0f0f0fu;
  x = (x | (x << 2)) & 0x33333333u;
  return (x | (x << 1)) & 0x55555555u;
}

}  // namespace

LevelBlocks::LevelBlocks(std::size_t fingerprints, std::size_t transmitters, std::span<const Level> levels)
    : padded_((fingerprints + kBlock - 1) / kBlock * kBlock), first_(transmitters + 1) {
  std::vector<Level> sorted(levels.begin(), levels.end());
  std::ranges::sort(sorted, [](const Level& a, const Level& b) {
    return a.transmitter != b.transmitter ? a.transmitter < b.transmitter : a.fingerprint < b.fingerprint;
  });
  std::uint32_t transmitter = 0;
  for (const Level& level : sorted) {
    assert(level.fingerprint < fingerprints && level.transmitter < transmitters);
    const auto start = static_cast<std::uint32_t>(level.fingerprint / kBlock * kBlock);
    const bool another = transmitter != level.transmitter;
    while (transmitter < level.transmitter) first_[++transmitter] = static_cast<std::uint32_t>(start_.size());
    if (another || start_.empty() || start_.back() != start) {
      start_.push_back(start);
      values_.resize(values_.size() + kBlock);
    }
    values_[(start_.size() - 1) * kBlock + level.fingerprint - start] = level.value;
  }
  while (transmitter < transmitters) first_[++transmitter] = static_cast<std::uint32_t>(start_.size());
}

void LevelBlocks::touch(std::uint32_t transmitter, std::span<std::uint8_t> touched, std::span<float> sums) const {
  for (std::uint32_t b = first_[transmitter]; b < first_[transmitter + 1]; ++b) {
    std::uint8_t& already = touched[start_[b] / kBlock];
    if (!already) std::ranges::fill(sums.subspan(start_[b], kBlock), 0.0f);
    already = 1;
  }
}

void LevelBlocks::add_products(std::uint32_t transmitter, float value, std::span<float> products) const {
  assert(products.size() == padded_);
  const std::uint32_t begin = first_[transmitter];
  HWY_DYNAMIC_DISPATCH(match::AddProducts)(start_.data() + begin, values_.data() + begin * kBlock, first_[transmitter + 1] - begin, value,
                                           products.data());
}

void LevelBlocks::add_overlaps_and_products(std::uint32_t transmitter, float value, std::span<float> overlaps,
                                            std::span<float> products) const {
  assert(overlaps.size() == padded_ && products.size() == padded_);
  const std::uint32_t begin = first_[transmitter];
  HWY_DYNAMIC_DISPATCH(match::AddOverlapsAndProducts)(start_.data() + begin, values_.data() + begin * kBlock,
                                                      first_[transmitter + 1] - begin, value, overlaps.data(), products.data());
}

void least_from_shared(std::span<const float> own, float all, std::span<const float> shared, std::span<const std::uint8_t> touched,
                       std::span<float> least_of_block) {
  HWY_DYNAMIC_DISPATCH(match::LeastFromShared)(own.data(), all, shared.data(), touched.data(), least_of_block.size(), least_of_block.data());
}

void similarity_distances(float total, std::span<const float> totals, std::span<const float> overlaps, std::span<float> sorensen,
                          float norm, std::span<const float> norms, std::span<const float> products, std::span<float> cosine) {
  HWY_DYNAMIC_DISPATCH(match::SimilarityDistances)(total, totals.data(), overlaps.data(), totals.size(), sorensen.data(), norm, norms.data(),
                                                   products.data(), cosine.data());
}

std::vector<std::uint32_t> space_filling_order(std::span<const Place> places) {
  double low_x = std::numeric_limits<double>::infinity(), low_y = low_x, high = 0.0;
  for (const Place& place : places) low_x = std::min(low_x, place.point.x_m), low_y = std::min(low_y, place.point.y_m);
  for (const Place& place : places) high = std::max({high, place.point.x_m - low_x, place.point.y_m - low_y});
  const double cells_per_m = high > 0.0 ? std::min(1.0, 65535.0 / high) : 1.0;
  std::vector<std::uint32_t> curve, order(places.size());
  for (const Place& place : places) {
    curve.push_back(spread(static_cast<std::uint32_t>((place.point.x_m - low_x) * cells_per_m)) |
                    spread(static_cast<std::uint32_t>((place.point.y_m - low_y) * cells_per_m)) << 1);
  }
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return places[a].floor != places[b].floor ? places[a].floor < places[b].floor : curve[a] < curve[b];
  });
  return order;
}

}  // namespace wayfuse
#endif  // HWY_ONCE
