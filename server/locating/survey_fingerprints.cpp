#include "server/locating/survey_fingerprints.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

namespace wayfuse {
namespace {

constexpr double kTogetherS = 0.5;       // members of one radio heard within this are averaged
constexpr double kSameReadingS = 0.05;   // the same cache row, handed out again
constexpr double kLongestGapS = 15.0;    // between places of a walk: across more, nobody knows the way
constexpr std::size_t kFewestRadios = 3;

struct Heard {
  double time_s = 0.0;
  double rss_dbm = 0.0;
};
struct Mark {
  double time_s = 0.0;
  Place place;
};
/// A survey walk put together again: where it went, and each radio's readings in time order.
struct Walk {
  std::vector<Mark> marks;
  std::map<std::uint64_t, std::vector<Heard>> radios;
};

bool readable(const ScanReading& reading) {
  return std::isfinite(reading.rss_dbm) && reading.rss_dbm > -130.0 && reading.rss_dbm < 1.0 && reading.age >= Duration{0};
}
bool readable(const Place& place) { return std::isfinite(place.point.x_m) && std::isfinite(place.point.y_m); }

double time_s(PhoneTime time) { return seconds(time.time_since_epoch()); }

void add(Walk& walk, const ReferencePoint& point) {
  for (const RssScan& scan : point.scans) {
    Duration oldest{0};
    for (const ScanReading& reading : scan.readings) oldest = std::max(oldest, reading.age);
    walk.marks.push_back({time_s(scan.time - oldest / 2), point.place});  // a surveyor places a scan by its middle
    for (const ScanReading& reading : scan.readings) {
      if (readable(reading)) walk.radios[RadioNames::key(reading)].push_back({time_s(scan.time - reading.age), reading.rss_dbm});
    }
  }
}

void put_in_order(Walk& walk) {
  std::ranges::stable_sort(walk.marks, {}, &Mark::time_s);
  for (auto& [_, readings] : walk.radios) std::ranges::stable_sort(readings, {}, &Heard::time_s);
}

std::optional<Place> place_at(const Walk& walk, double at_s) {
  const auto after = std::ranges::lower_bound(walk.marks, at_s, {}, &Mark::time_s);
  if (after == walk.marks.end()) return std::nullopt;
  if (after == walk.marks.begin()) return after->time_s == at_s ? std::optional(after->place) : std::nullopt;
  const Mark& a = *(after - 1);
  const Mark& b = *after;
  if (b.time_s - a.time_s > kLongestGapS || a.place.floor != b.place.floor) return std::nullopt;
  const double share = (at_s - a.time_s) / std::max(1e-6, b.time_s - a.time_s);
  return Place{{a.place.point.x_m + share * (b.place.point.x_m - a.place.point.x_m),
                a.place.point.y_m + share * (b.place.point.y_m - a.place.point.y_m)},
               a.place.floor};
}

/// Mean level of the readings around `at`, one per virtual access point of the radio.
double level_around(const std::vector<Heard>& readings, double at_s) {
  double sum = 0.0;
  int count = 0;
  for (auto each = std::ranges::lower_bound(readings, at_s - kTogetherS, {}, &Heard::time_s);
       each != readings.end() && each->time_s <= at_s + kTogetherS; ++each) {
    sum += each->rss_dbm;
    ++count;
  }
  return sum / count;
}

/// Nearest reading in time, looking back only or both ways.
const Heard* nearest(const std::vector<Heard>& readings, double at_s, bool both_ways) {
  const auto after = std::ranges::upper_bound(readings, at_s, {}, &Heard::time_s);
  const Heard* before = after == readings.begin() ? nullptr : &*(after - 1);
  if (!both_ways || after == readings.end()) return before;
  return before && at_s - before->time_s <= after->time_s - at_s ? before : &*after;
}

}  // namespace

float ReadingStrength::of(double rss_dbm, double age_s) const {
  if (age_s > most_age_s || rss_dbm <= -100.0) return 0.0f;
  const double level = std::pow(std::min(1.0, (rss_dbm + 100.0) / 100.0), power);
  return static_cast<float>(level * std::exp(-std::max(0.0, age_s - fresh_s) / fade_s));
}

std::uint64_t RadioNames::key(const ScanReading& reading) {
  return (reading.bssid.value & 0xffff'ffff'ffu) << 16 | reading.frequency_mhz;
}

std::optional<std::uint32_t> RadioNames::find(std::uint64_t key) const {
  const auto found = std::ranges::lower_bound(keys_, key);
  if (found == keys_.end() || *found != key) return std::nullopt;
  return static_cast<std::uint32_t>(found - keys_.begin());
}

/// Turns walks and standing points into fingerprints and queries over one set of radios.
class FingerprintMaker {
 public:
  explicit FingerprintMaker(const SurveyReadingSettings& settings) : settings_(settings) {}

  SurveyReading make(std::span<const ReferencePoint> survey) {
    sort_out(survey);
    name_radios();
    for (const auto& [_, walk] : walks_) read(walk, next_walk_++);
    for (const ReferencePoint* point : standing_) read(*point, next_walk_++);
    return std::move(result_);
  }

 private:
  void sort_out(std::span<const ReferencePoint> survey) {
    for (const ReferencePoint& point : survey) {
      if (!readable(point.place)) continue;
      if (point.walk.empty()) standing_.push_back(&point);
      else add(walks_[point.walk], point);
    }
    for (auto& [_, walk] : walks_) put_in_order(walk);
    int source = 0;
    const auto note = [&](const ScanReading& reading, const std::string& walk) {
      if (!readable(reading)) return;
      Witness& witness = witnesses_[RadioNames::key(reading)];
      witness.fixed = witness.fixed || !reading.bssid.locally_administered();
      witness.readings++;
      witness.sources.insert(walk.empty() ? std::to_string(source) : walk);
    };
    for (const ReferencePoint& point : survey) {
      ++source;
      for (const RssScan& scan : point.scans) {
        for (const ScanReading& reading : scan.readings) note(reading, point.walk);
      }
    }
  }

  void name_radios() {
    for (const auto& [key, witness] : witnesses_) {
      const bool trusted = witness.fixed || static_cast<int>(witness.sources.size()) >= RadioNames::kWalksToTrust;
      if (trusted && witness.readings > 1) result_.radios.keys_.push_back(key);
    }
    witnesses_.clear();
  }

  void read(const Walk& walk, int number) {
    if (walk.marks.empty()) return;
    const double begin_s = walk.marks.front().time_s;
    const double end_s = walk.marks.back().time_s;
    for (double at_s = begin_s; at_s <= end_s; at_s += settings_.spacing_s) {
      if (const auto place = place_at(walk, at_s)) keep(result_.fingerprints, {*place, number, heard(walk, at_s, true)});
    }
    for (double at_s = begin_s + settings_.query_every_s; at_s <= end_s; at_s += settings_.query_every_s) {
      query(walk, at_s, number);
    }
  }

  /// As a phone hands it over at `now`: the newest reading of each radio, placed where most of it belongs.
  void query(const Walk& walk, double now_s, int number) {
    const auto levels = heard(walk, now_s + settings_.delay_s, false);
    double weight = 0.0;
    double ages_s = 0.0;
    for (const RadioStrength& level : levels) {
      weight += level.strength;
      ages_s += level.strength * last_age_s_[level.radio];
    }
    if (weight <= 0.0) return;
    const double matched_s = std::min(now_s, now_s - ages_s / weight + settings_.delay_s);
    if (const auto place = place_at(walk, matched_s)) keep(result_.queries, {*place, number, levels});
  }

  std::vector<RadioStrength> heard(const Walk& walk, double at_s, bool both_ways) {
    last_age_s_.resize(result_.radios.size());
    std::vector<RadioStrength> levels;
    const double sought_s = at_s - settings_.delay_s;
    for (const auto& [key, readings] : walk.radios) {
      const auto radio = result_.radios.find(key);
      if (!radio) continue;
      const Heard* reading = nearest(readings, sought_s, both_ways);
      if (!reading) continue;
      const double age_s = std::abs(sought_s - reading->time_s);
      if (both_ways && age_s > settings_.reach_s) continue;
      // Seen from both sides a reading is nearer in time: it begins to fade a second earlier, to count alike in the end.
      const float strength = settings_.strength.of(level_around(readings, reading->time_s), both_ways ? age_s + 1.0 : age_s);
      if (strength > 0.0f) levels.push_back({*radio, strength});
      last_age_s_[*radio] = age_s;
    }
    std::ranges::sort(levels, {}, &RadioStrength::radio);
    return levels;
  }

  void read(const ReferencePoint& point, int number) {
    std::map<std::uint32_t, std::pair<double, int>> sums;
    for (const RssScan& scan : point.scans) {
      for (const ScanReading& reading : scan.readings) {
        const auto radio = result_.radios.find(RadioNames::key(reading));
        if (!radio || !readable(reading) || seconds(reading.age) > settings_.strength.most_age_s) continue;
        sums[*radio].first += reading.rss_dbm;
        sums[*radio].second++;
      }
    }
    std::vector<RadioStrength> levels;
    for (const auto& [radio, sum] : sums) {
      const float strength = settings_.strength.of(sum.first / sum.second, 0.0);
      if (strength > 0.0f) levels.push_back({radio, strength});
    }
    keep(result_.queries, {point.place, number, levels});
    keep(result_.fingerprints, {point.place, number, std::move(levels)});
  }

  template <typename List>
  void keep(List& list, typename List::value_type value) {
    if (value.heard.size() >= std::min<std::size_t>(kFewestRadios, result_.radios.size()) && !value.heard.empty()) {
      list.push_back(std::move(value));
    }
  }

  struct Witness {
    bool fixed = false;
    int readings = 0;
    std::set<std::string> sources;
  };
  SurveyReadingSettings settings_;
  SurveyReading result_;
  std::map<std::string, Walk> walks_;
  std::vector<const ReferencePoint*> standing_;
  std::map<std::uint64_t, Witness> witnesses_;
  std::vector<double> last_age_s_;
  int next_walk_ = 0;
};

SurveyReading read_survey(std::span<const ReferencePoint> survey, const SurveyReadingSettings& settings) {
  return FingerprintMaker(settings).make(survey);
}

}  // namespace wayfuse
