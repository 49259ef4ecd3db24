#include "server/locating/radio_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "server/locating/level_blocks.hpp"

namespace wayfuse {
namespace {

struct Sum {
  double dbm = 0.0;
  double squares = 0.0;
  int readings = 0;
  int scans = 0;
};

std::map<Bssid, Sum> sum_up(const ReferencePoint& point) {
  std::map<Bssid, Sum> sums;
  for (const RssScan& scan : point.scans) {
    std::map<Bssid, int> in_scan;
    for (const ScanReading& reading : scan.readings) {
      if (!usable(reading)) continue;
      Sum& sum = sums[reading.bssid];
      sum.dbm += reading.rss_dbm;
      sum.squares += reading.rss_dbm * reading.rss_dbm;
      ++sum.readings;
      if (++in_scan[reading.bssid] == 1) ++sum.scans;
    }
  }
  return sums;
}

MapLevel level_of(std::uint32_t transmitter, const Sum& sum) {
  const double mean = sum.dbm / sum.readings;
  const double variance = sum.readings > 1 ? std::max(0.0, (sum.squares - sum.dbm * mean) / (sum.readings - 1)) : 0.0;
  return {transmitter, static_cast<float>(mean), static_cast<float>(std::sqrt(variance)),
          static_cast<std::uint16_t>(std::min(sum.scans, 65535))};
}

bool finite(const Place& place) { return std::isfinite(place.point.x_m) && std::isfinite(place.point.y_m); }

}  // namespace

bool usable(const ScanReading& reading) {
  return std::isfinite(reading.rss_dbm) && reading.rss_dbm < 1.0 && reading.rss_dbm > -130.0;
}

namespace {

// Locally administered addresses heard at one point only: a phone's hot spot that passed by.
void drop_passing_hot_spots(std::vector<std::map<Bssid, Sum>>& points) {
  std::map<Bssid, int> heard_at;
  for (const auto& point : points) {
    for (const auto& [bssid, _] : point) {
      if (bssid.locally_administered()) ++heard_at[bssid];
    }
  }
  for (auto& point : points) {
    std::erase_if(point, [&](const auto& entry) { return entry.first.locally_administered() && heard_at[entry.first] < 2; });
  }
}

}  // namespace

std::shared_ptr<const RadioMap> RadioMap::build(std::span<const ReferencePoint> survey) {
  auto map = std::make_shared<RadioMap>();
  std::vector<std::map<Bssid, Sum>> sums;
  std::vector<const ReferencePoint*> kept;
  for (const ReferencePoint& point : survey) {
    if (!finite(point.place)) continue;
    sums.push_back(sum_up(point));
    kept.push_back(&point);
  }
  drop_passing_hot_spots(sums);
  for (const auto& sum : sums) {
    for (const auto& [bssid, _] : sum) map->transmitters_.push_back(bssid);
  }
  std::ranges::sort(map->transmitters_);
  const auto [first, last] = std::ranges::unique(map->transmitters_);
  map->transmitters_.erase(first, last);

  std::vector<Place> places;
  for (const ReferencePoint* point : kept) places.push_back(point->place);
  for (const std::uint32_t i : space_filling_order(places)) {
    if (sums[i].empty()) continue;
    MapPoint point{kept[i]->place, static_cast<std::uint32_t>(map->levels_.size()), static_cast<std::uint32_t>(sums[i].size()),
                   static_cast<std::uint16_t>(std::min<std::size_t>(kept[i]->scans.size(), 65535))};
    for (const auto& [bssid, sum] : sums[i]) map->levels_.push_back(level_of(*map->index_of(bssid), sum));
    map->points_.push_back(point);
    map->floors_.push_back(point.place.floor);
  }
  std::ranges::sort(map->floors_);
  const auto [floor_first, floor_last] = std::ranges::unique(map->floors_);
  map->floors_.erase(floor_first, floor_last);
  return map;
}

RadioMap::Range RadioMap::points_on(FloorOrdinal floor) const {
  const auto on = std::ranges::equal_range(points_, floor, {}, [](const MapPoint& point) { return point.place.floor; });
  return {static_cast<std::uint32_t>(on.begin() - points_.begin()), static_cast<std::uint32_t>(on.end() - points_.begin())};
}

std::optional<std::uint32_t> RadioMap::index_of(Bssid bssid) const {
  const auto found = std::ranges::lower_bound(transmitters_, bssid);
  if (found == transmitters_.end() || *found != bssid) return std::nullopt;
  return static_cast<std::uint32_t>(found - transmitters_.begin());
}

void RadioMap::know(const RssScan& scan, KnownScan& out) const {
  out.levels.clear();
  out.unknown = 0;
  for (const ScanReading& reading : scan.readings) {
    if (!usable(reading)) continue;
    if (const auto index = index_of(reading.bssid)) {
      out.levels.push_back({*index, static_cast<float>(reading.rss_dbm), static_cast<float>(seconds(reading.age))});
    } else {
      ++out.unknown;
    }
  }
  std::ranges::sort(out.levels, [](const auto& a, const auto& b) {
    return std::tie(a.transmitter, a.age_s, a.rss_dbm) < std::tie(b.transmitter, b.age_s, b.rss_dbm);
  });
  const auto [first, last] = std::ranges::unique(out.levels, {}, &KnownScan::Level::transmitter);
  out.levels.erase(first, last);
}

}  // namespace wayfuse
