#include "server/buildings/device_offsets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace wayfuse {
namespace {

constexpr double kTogether_m = 3.0;
constexpr std::size_t kFewestDifferences = 60;
constexpr std::size_t kFewestPlaces = 5;
constexpr std::size_t kFewestTransmitters = 5;
constexpr std::size_t kFewestEach = 4;   // differences, for a transmitter to have a say
constexpr double kNegligible_db = 1.0;
constexpr double kFaint_dbm = -88.0;     // below, only lucky readings are heard: their mean is too loud

struct Level {
  std::uint32_t transmitter = 0;
  double rss_dbm = 0.0;
};

struct SurveyedPoint {
  Place place;
  std::vector<Level> levels;             // mean of its readings a transmitter, ascending
};

std::vector<Bssid> transmitters_in(std::span<const ReferencePoint> survey) {
  std::vector<Bssid> all;
  for (const ReferencePoint& point : survey) {
    for (const RssScan& scan : point.scans) {
      for (const ScanReading& reading : scan.readings) all.push_back(reading.bssid);
    }
  }
  std::ranges::sort(all);
  const auto rest = std::ranges::unique(all);
  all.erase(rest.begin(), rest.end());
  return all;
}

SurveyedPoint levels_of(const ReferencePoint& point, const std::vector<Bssid>& transmitters) {
  std::map<Bssid, std::pair<double, int>> sums;
  for (const RssScan& scan : point.scans) {
    for (const ScanReading& reading : scan.readings) {
      auto& sum = sums[reading.bssid];
      sum.first += reading.rss_dbm;
      sum.second++;
    }
  }
  SurveyedPoint surveyed{point.place, {}};
  for (const auto& [bssid, sum] : sums) {
    const auto number = std::ranges::lower_bound(transmitters, bssid) - transmitters.begin();
    surveyed.levels.push_back({static_cast<std::uint32_t>(number), sum.first / sum.second});
  }
  return surveyed;
}

/// Levelled points in squares of kTogether_m.
class Ground {
 public:
  explicit Ground(std::size_t transmitters) : sum_dbm_(transmitters, 0.0), count_(transmitters, 0) {}

  void add(const SurveyedPoint& point, double offset_db) { squares_[square_of(point.place)].push_back({&point, offset_db}); }

  /// Visits transmitter and difference to the mean of the levelled points around; false where none lies there.
  template <typename Visit>
  bool compare(const SurveyedPoint& point, Visit visit) {
    bool met = false;
    for (const Levelled& other : around(point.place)) {
      met = true;
      for (const Level& level : other.point->levels) {
        sum_dbm_[level.transmitter] += level.rss_dbm - other.offset_db;
        count_[level.transmitter]++;
        touched_.push_back(level.transmitter);
      }
    }
    for (const Level& level : point.levels) {
      if (count_[level.transmitter] == 0) continue;
      const double mean_dbm = sum_dbm_[level.transmitter] / count_[level.transmitter];
      if (level.rss_dbm + mean_dbm > 2.0 * kFaint_dbm) visit(level.transmitter, level.rss_dbm - mean_dbm);
    }
    for (const std::uint32_t transmitter : touched_) sum_dbm_[transmitter] = 0.0, count_[transmitter] = 0;
    touched_.clear();
    return met;
  }

 private:
  using Square = std::array<std::int64_t, 3>;  // floor, column, row
  struct Levelled {
    const SurveyedPoint* point;
    double offset_db;
  };
  static Square square_of(Place place) {
    return {place.floor.value, static_cast<std::int64_t>(std::floor(place.point.x_m / kTogether_m)),
            static_cast<std::int64_t>(std::floor(place.point.y_m / kTogether_m))};
  }
  std::vector<Levelled> around(Place place) const {
    std::vector<Levelled> found;
    const Square middle = square_of(place);
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const auto square = squares_.find({middle[0], middle[1] + dx, middle[2] + dy});
        if (square == squares_.end()) continue;
        for (const Levelled& other : square->second) {
          if (distance_m(other.point->place.point, place.point) <= kTogether_m) found.push_back(other);
        }
      }
    }
    return found;
  }

  std::map<Square, std::vector<Levelled>> squares_;
  std::vector<double> sum_dbm_;
  std::vector<int> count_;
  std::vector<std::uint32_t> touched_;
};

/// Mean of the middle half: as deaf to a quarter of strangers as it must be, and finer than a median of whole decibels.
double midmean(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t off = values.size() / 4;
  double sum = 0.0;
  for (std::size_t i = off; i < values.size() - off; ++i) sum += values[i];
  return sum / static_cast<double>(values.size() - 2 * off);
}

/// What the ground says of a model; absent where it says too little. `level` has the counts in any case.
std::optional<double> offset_against(Ground& ground, const std::vector<SurveyedPoint>& points, DeviceLevel& level) {
  std::map<std::uint32_t, std::vector<double>> differences_db;
  std::size_t all = 0;
  level.places = level.transmitters = 0;
  for (const SurveyedPoint& point : points) {
    level.places += ground.compare(point, [&](std::uint32_t transmitter, double difference_db) {
      differences_db[transmitter].push_back(difference_db);
      ++all;
    });
  }
  std::vector<double> each_db;
  for (auto& [transmitter, differences] : differences_db) {
    if (differences.size() >= kFewestEach) each_db.push_back(midmean(std::move(differences)));
  }
  level.transmitters = each_db.size();
  if (all < kFewestDifferences || level.places < kFewestPlaces || level.transmitters < kFewestTransmitters) return std::nullopt;
  return midmean(std::move(each_db));
}

}  // namespace

std::string_view name_of(DeviceLevel::Standing standing) {
  switch (standing) {
    case DeviceLevel::Standing::kReference: return "reference";
    case DeviceLevel::Standing::kLearnt: return "learnt";
    case DeviceLevel::Standing::kAgrees: return "agrees";
    case DeviceLevel::Standing::kUnknown: break;
  }
  return "unknown";
}

std::vector<DeviceLevel> learn_device_levels(std::span<const ReferencePoint> survey) {
  std::map<std::string, std::size_t> counts;
  for (const ReferencePoint& point : survey) counts[point.device_model]++;
  std::vector<DeviceLevel> levels;
  for (const auto& [model, points] : counts) levels.push_back({.model = model, .points = points});
  std::ranges::stable_sort(levels, std::greater{}, &DeviceLevel::points);
  if (levels.empty()) return levels;
  levels.front().standing = DeviceLevel::Standing::kReference;
  if (levels.size() == 1) return levels;

  const std::vector<Bssid> transmitters = transmitters_in(survey);
  std::map<std::string, std::vector<SurveyedPoint>> by_model;
  for (const ReferencePoint& point : survey) by_model[point.device_model].push_back(levels_of(point, transmitters));
  Ground ground(transmitters.size());
  for (const SurveyedPoint& point : by_model[levels.front().model]) ground.add(point, 0.0);
  for (bool grown = true; grown;) {
    grown = false;
    std::vector<DeviceLevel*> levelled;  // all of a round against the same ground: their order says nothing
    for (DeviceLevel& level : levels) {
      if (level.standing != DeviceLevel::Standing::kUnknown || level.model.empty()) continue;
      const auto offset_db = offset_against(ground, by_model[level.model], level);
      if (!offset_db) continue;
      level.standing = std::abs(*offset_db) >= kNegligible_db ? DeviceLevel::Standing::kLearnt : DeviceLevel::Standing::kAgrees;
      level.offset_db = *offset_db;
      levelled.push_back(&level);
    }
    for (const DeviceLevel* level : levelled) {
      const double taken_out_db = level->standing == DeviceLevel::Standing::kLearnt ? level->offset_db : 0.0;
      for (const SurveyedPoint& point : by_model[level->model]) ground.add(point, taken_out_db);
      grown = true;
    }
  }
  return levels;
}

std::map<std::string, double> offsets_of(std::span<const DeviceLevel> levels) {
  std::map<std::string, double> offsets_db;
  for (const DeviceLevel& level : levels) {
    if (level.standing == DeviceLevel::Standing::kLearnt) offsets_db[level.model] = level.offset_db;
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
