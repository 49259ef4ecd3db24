#include "server/locating/rss_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wayfuse {
namespace {

constexpr double kHalfUlp = 0x1.0p-24;       // of a float: the rounding of one operation, against its result

}  // namespace

RssDistance::RssDistance(std::shared_ptr<const RadioMap> map, const RssDistanceSettings& settings)
    : map_(std::move(map)), settings_(settings) {
  std::vector<LevelBlocks::Level> levels;
  for (std::uint32_t j = 0; j < map_->points().size(); ++j) {
    double silence = 0.0;
    for (const MapLevel& level : map_->levels(map_->points()[j])) {
      const double above = static_cast<double>(level.mean_dbm) - settings_.floor_dbm;
      silence += power(above);
      levels.push_back({j, level.transmitter, static_cast<float>(above)});
    }
    against_silence_.push_back(static_cast<float>(silence));
    most_against_silence_ = std::max(most_against_silence_, silence);
  }
  blocks_ = LevelBlocks(map_->points().size(), map_->transmitters().size(), levels);
  against_silence_.resize(blocks_.padded(), std::numeric_limits<float>::infinity());
  for (auto block = against_silence_.begin(); block != against_silence_.end(); block += LevelBlocks::kBlock) {
    least_against_silence_.push_back(*std::min_element(block, block + LevelBlocks::kBlock));
  }
}

double RssDistance::power(double difference) const {
  const double size = std::abs(difference);
  if (settings_.exponent == 1.0) return size;
  if (settings_.exponent == 2.0) return size * size;
  return std::pow(size, settings_.exponent);
}

double RssDistance::root(double powered) const {
  if (settings_.exponent == 1.0) return powered;
  if (settings_.exponent == 2.0) return std::sqrt(powered);
  return std::pow(powered, 1.0 / settings_.exponent);
}

void RssDistance::approximate(const KnownScan& scan, Approximate& out) const {
  out.shared.resize(blocks_.padded());
  out.touched.assign(least_against_silence_.size(), 0);
  for (const KnownScan::Level& level : scan.levels) blocks_.touch(level.transmitter, out.touched, out.shared);
  if (settings_.exponent == 1.0) out.products.assign(blocks_.padded(), 0.0f);
  double scan_silence = 0.0;
  for (const KnownScan::Level& level : scan.levels) {
    const double above = static_cast<double>(level.rss_dbm) - settings_.floor_dbm;
    scan_silence += power(above);
    const auto value = static_cast<float>(above);
    if (settings_.exponent == 2.0) {
      blocks_.add_products(level.transmitter, value, out.shared);
    } else if (settings_.exponent == 1.0) {
      blocks_.add_overlaps_and_products(level.transmitter, value, out.shared, out.products);
    } else {
      const double alone = power(above);
      blocks_.for_each_level(level.transmitter, [&](std::uint32_t point, float at_point) {
        const double both = alone + power(at_point) - power(above - static_cast<double>(at_point));
        out.shared[point] += static_cast<float>(0.5 * both);
      });
    }
  }
  out.scan_alone = static_cast<float>(scan_silence);
  out.least.resize(least_against_silence_.size());
  std::ranges::transform(least_against_silence_, out.least.begin(), [&](float alone) { return alone + out.scan_alone; });
  least_from_shared(against_silence_, out.scan_alone, out.shared, out.touched, out.least);
  // No partial sum exceeds all of |S|^a, |R|^a and 2 shared <= (1 + 2^(a-1)) (|S|^a + |R|^a); each level adds two roundings.
  const double magnitude = (2.0 + std::exp2(settings_.exponent)) * (most_against_silence_ + scan_silence);
  out.bound = static_cast<float>(kHalfUlp * (2.0 * static_cast<double>(scan.levels.size()) + 8.0) * magnitude);
}

double RssDistance::powered(const KnownScan& scan, std::uint32_t point) const {
  const auto at_point = map_->levels(map_->points()[point]);
  double sum = 0.0;
  auto here = at_point.begin();
  for (const KnownScan::Level& level : scan.levels) {
    for (; here != at_point.end() && here->transmitter < level.transmitter; ++here) sum += power(static_cast<double>(here->mean_dbm) - settings_.floor_dbm);
    const bool both = here != at_point.end() && here->transmitter == level.transmitter;
    sum += power(static_cast<double>(level.rss_dbm) - (both ? static_cast<double>(here++->mean_dbm) : settings_.floor_dbm));
  }
  for (; here != at_point.end(); ++here) sum += power(static_cast<double>(here->mean_dbm) - settings_.floor_dbm);
  return sum;
}

void RssDistance::nearest(const KnownScan& scan, const Approximate& approximate, std::size_t k, std::uint32_t begin,
                          std::uint32_t end, std::vector<Neighbour>& found) const {
  constexpr auto kBlock = static_cast<std::uint32_t>(LevelBlocks::kBlock);
  found.clear();
  // The k-th smallest approximate distance; blocks whose least lies beyond it are not looked into.
  float limit = std::numeric_limits<float>::infinity();
  const auto each_within = [&](const auto& act) {
    for (std::uint32_t block = begin / kBlock; block * kBlock < end; ++block) {
      if (!(approximate.least[block] <= limit)) continue;
      const std::uint32_t last = std::min(end, (block + 1) * kBlock);
      for (std::uint32_t j = std::max(begin, block * kBlock); j < last; ++j) {
        if (const float distance = powered(approximate, j); distance <= limit) act(j, distance);
      }
    }
  };
  each_within([&](std::uint32_t j, float distance) {
    if (found.size() == k) {
      std::ranges::pop_heap(found, std::less<>{});
      found.pop_back();
    }
    found.push_back({j, static_cast<double>(distance)});
    std::ranges::push_heap(found, std::less<>{});
    if (found.size() == k) limit = static_cast<float>(found.front().powered);
  });
  if (found.size() == k) limit += 2.0f * approximate.bound;
  found.clear();
  each_within([&](std::uint32_t j, float) { found.push_back({j, powered(scan, j)}); });
  const std::size_t wanted = std::min(k, found.size());
  std::ranges::partial_sort(found, found.begin() + static_cast<std::ptrdiff_t>(wanted), std::less<>{});
  found.resize(wanted);
}

}  // namespace wayfuse
