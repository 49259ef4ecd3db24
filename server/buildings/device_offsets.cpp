#include "server/buildings/device_offsets.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse {
namespace {

constexpr double kTogether_m = 3.0;
constexpr std::size_t kFewestDifferences = 60;
constexpr std::size_t kFewestPlaces = 5;
constexpr double kNegligible_db = 1.0;
constexpr double kFaint_dbm = -88.0;     // below, only lucky readings are heard: their mean is too loud

using Levels = std::map<Bssid, double>;

Levels levels_of(const ReferencePoint& point) {
  std::map<Bssid, std::pair<double, int>> sums;
  for (const RssScan& scan : point.scans) {
    for (const ScanReading& reading : scan.readings) {
      auto& sum = sums[reading.bssid];
      sum.first += reading.rss_dbm;
      sum.second++;
    }
  }
  Levels levels;
  for (const auto& [bssid, sum] : sums) levels[bssid] = sum.first / sum.second;
  return levels;
}

struct Surveyed {
  Place place;
  Levels levels;
};

/// Points of one model in squares of kTogether_m.
class Ground {
 public:
  void add(Surveyed point) {
    const Square square = square_of(point.place);
    squares_[square].push_back(std::move(point));
  }
  template <typename Visit>
  void near(Place place, Visit visit) const {
    const Square middle = square_of(place);
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const auto found = squares_.find({middle.floor, middle.x + dx, middle.y + dy});
        if (found == squares_.end()) continue;
        for (const Surveyed& point : found->second) {
          if (distance_m(point.place.point, place.point) <= kTogether_m) visit(point);
        }
      }
    }
  }

 private:
  struct Square {
    std::int32_t floor = 0;
    std::int64_t x = 0, y = 0;
    auto operator<=>(const Square&) const = default;
  };
  static Square square_of(Place place) {
    return {place.floor.value, static_cast<std::int64_t>(std::floor(place.point.x_m / kTogether_m)),
            static_cast<std::int64_t>(std::floor(place.point.y_m / kTogether_m))};
  }
  std::map<Square, std::vector<Surveyed>> squares_;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

std::map<std::string, double> learn_device_offsets(std::span<const ReferencePoint> survey) {
  std::map<std::string, std::size_t> points;
  for (const ReferencePoint& point : survey) points[point.device_model]++;
  std::map<std::string, double> offsets_db;
  if (points.size() < 2) return offsets_db;
  const auto usual = std::ranges::max_element(points, {}, [](const auto& each) { return each.second; })->first;
  Ground ground;
  for (const ReferencePoint& point : survey) {
    if (point.device_model == usual) ground.add({point.place, levels_of(point)});
  }
  std::map<std::string, std::vector<double>> differences_db;
  std::map<std::string, std::size_t> places;
  for (const ReferencePoint& point : survey) {
    if (point.device_model == usual || point.device_model.empty()) continue;
    const Levels heard = levels_of(point);
    bool met = false;
    ground.near(point.place, [&](const Surveyed& other) {
      met = true;
      for (const auto& [bssid, level] : heard) {
        const auto same = other.levels.find(bssid);
        if (same != other.levels.end() && level + same->second > 2.0 * kFaint_dbm) differences_db[point.device_model].push_back(level - same->second);
      }
    });
    places[point.device_model] += met;
  }
  for (const auto& [model, differences] : differences_db) {
    if (differences.size() < kFewestDifferences || places[model] < kFewestPlaces) continue;
    const double offset_db = median(differences);
    if (std::abs(offset_db) >= kNegligible_db) offsets_db[model] = offset_db;
  }
  return offsets_db;
}

void apply_device_offsets(const std::map<std::string, double>& offsets_db, std::vector<ReferencePoint>& survey) {
  if (offsets_db.empty()) return;
  for (ReferencePoint& point : survey) {
    const auto offset = offsets_db.find(point.device_model);
    if (offset == offsets_db.end()) continue;
    for (RssScan& scan : point.scans) {
      for (ScanReading& reading : scan.readings) reading.rss_dbm = std::clamp(reading.rss_dbm - offset->second, -120.0, 0.0);
    }
  }
}

}  // namespace wayfuse
