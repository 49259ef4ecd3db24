#include "server/buildings/survey_levels.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace wayfuse {

SurveyLevels::SurveyLevels(std::span<const ReferencePoint> survey) {
  std::set<Bssid> heard;
  for (const ReferencePoint& point : survey) {
    for (const RssScan& scan : point.scans) {
      for (const ScanReading& reading : scan.readings) heard.insert(reading.bssid);
    }
  }
  transmitters_.assign(heard.begin(), heard.end());
  for (const ReferencePoint& point : survey) {
    std::map<std::uint32_t, std::pair<double, int>> sums;
    for (const RssScan& scan : point.scans) {
      for (const ScanReading& reading : scan.readings) {
        const auto number = static_cast<std::uint32_t>(std::ranges::lower_bound(transmitters_, reading.bssid) - transmitters_.begin());
        sums[number].first += reading.rss_dbm;
        sums[number].second++;
      }
    }
    cells_[cell_of(point.place)].push_back(static_cast<std::uint32_t>(points_.size()));
    const auto begin = static_cast<std::uint32_t>(levels_.size());
    for (const auto& [number, sum] : sums) levels_.push_back({number, static_cast<float>(sum.first / sum.second)});
    points_.push_back({point.place, begin, static_cast<std::uint32_t>(levels_.size())});
  }
}

SurveyLevels::Cell SurveyLevels::cell_of(Place place) {
  return {place.floor.value,
          {static_cast<std::int32_t>(std::floor(place.point.x_m / kAround_m)), static_cast<std::int32_t>(std::floor(place.point.y_m / kAround_m))}};
}

bool SurveyLevels::knows(Bssid bssid) const { return std::ranges::binary_search(transmitters_, bssid); }

std::vector<SurveyLevels::Expectation> SurveyLevels::expect(Place place, std::size_t least) const {
  std::map<std::uint32_t, std::pair<double, double>> sums;
  std::size_t points = 0;
  const Cell middle = cell_of(place);
  for (std::int32_t dx = -1; dx <= 1; ++dx) {
    for (std::int32_t dy = -1; dy <= 1; ++dy) {
      const auto cell = cells_.find({middle.first, {middle.second.first + dx, middle.second.second + dy}});
      if (cell == cells_.end()) continue;
      for (const std::uint32_t number : cell->second) {
        const Point& point = points_[number];
        if (distance_m(point.place.point, place.point) > kAround_m) continue;
        ++points;
        for (std::uint32_t i = point.begin; i < point.end; ++i) {
          sums[levels_[i].transmitter].first += static_cast<double>(levels_[i].rss_dbm);
          sums[levels_[i].transmitter].second += 1.0;
        }
      }
    }
  }
  std::vector<Expectation> expected;
  if (points < least) return expected;
  for (const auto& [number, sum] : sums) {
    expected.push_back({transmitters_[number], sum.first / sum.second, sum.second / static_cast<double>(points)});
  }
  return expected;
}

std::vector<Place> SurveyLevels::where_heard(Bssid bssid, double least_dbm, double apart_m, std::size_t most) const {
  const auto number = static_cast<std::uint32_t>(std::ranges::lower_bound(transmitters_, bssid) - transmitters_.begin());
  std::vector<std::pair<float, Place>> found;
  for (const Point& point : points_) {
    for (std::uint32_t i = point.begin; i < point.end; ++i) {
      if (levels_[i].transmitter == number && static_cast<double>(levels_[i].rss_dbm) >= least_dbm) found.emplace_back(levels_[i].rss_dbm, point.place);
    }
  }
  std::ranges::stable_sort(found, std::greater{}, [](const auto& each) { return each.first; });
  std::vector<Place> places;
  for (const auto& [_, place] : found) {
    if (places.size() == most) break;
    const bool apart = std::ranges::all_of(places, [&](const Place& other) {
      return other.floor != place.floor || distance_m(other.point, place.point) >= apart_m;
    });
    if (apart) places.push_back(place);
  }
  return places;
}

}  // namespace wayfuse
