#include "server/locating/rss_distance.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace wayfuse {

RssDistance::RssDistance(std::shared_ptr<const RadioMap> map, const RssDistanceSettings& settings)
    : map_(std::move(map)), settings_(settings), first_heard_(map_->transmitters().size() + 1) {
  for (const MapLevel& level : map_->levels()) ++first_heard_[level.transmitter + 1];
  for (std::size_t i = 1; i < first_heard_.size(); ++i) first_heard_[i] += first_heard_[i - 1];
  heard_.resize(map_->levels().size());
  auto next = first_heard_;
  for (std::uint32_t j = 0; j < map_->points().size(); ++j) {
    double silence = 0.0;
    for (const MapLevel& level : map_->levels(map_->points()[j])) {
      silence += power(static_cast<double>(level.mean_dbm) - settings_.floor_dbm);
      heard_[next[level.transmitter]++] = {j, level.mean_dbm};
    }
    against_silence_.push_back(silence);
  }
}

double RssDistance::power(double difference) const {
  const double size = std::abs(difference);
  if (settings_.exponent == 1.0) return size;
  if (settings_.exponent == 2.0) return size * size;
  return std::pow(size, settings_.exponent);
}

double RssDistance::root(double powered) const {
  const double positive = std::max(0.0, powered);  // rounding may leave a hair below zero
  if (settings_.exponent == 1.0) return positive;
  if (settings_.exponent == 2.0) return std::sqrt(positive);
  return std::pow(positive, 1.0 / settings_.exponent);
}

template <typename Power>
void RssDistance::accumulate(const KnownScan& scan, std::span<double> out, const Power& power) const {
  for (const auto& level : scan.levels) {
    const double rss_dbm = level.rss_dbm;
    const double silent = power(rss_dbm - settings_.floor_dbm);
    for (std::uint32_t k = first_heard_[level.transmitter]; k < first_heard_[level.transmitter + 1]; ++k) {
      const double mean_dbm = heard_[k].mean_dbm;
      out[heard_[k].point] += power(rss_dbm - mean_dbm) - power(mean_dbm - settings_.floor_dbm) - silent;
    }
  }
}

void RssDistance::powered(const KnownScan& scan, std::span<double> out) const {
  assert(out.size() == against_silence_.size());
  double scan_silence = 0.0;
  for (const auto& level : scan.levels) scan_silence += power(static_cast<double>(level.rss_dbm) - settings_.floor_dbm);
  for (std::size_t j = 0; j < out.size(); ++j) out[j] = against_silence_[j] + scan_silence;
  // The exponent is looked at once a scan, not once a reading.
  if (settings_.exponent == 2.0) {
    accumulate(scan, out, [](double difference) { return difference * difference; });
  } else if (settings_.exponent == 1.0) {
    accumulate(scan, out, [](double difference) { return std::abs(difference); });
  } else {
    accumulate(scan, out, [this](double difference) { return std::pow(std::abs(difference), settings_.exponent); });
  }
}

}  // namespace wayfuse
