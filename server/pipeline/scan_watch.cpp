#include "server/pipeline/scan_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wayfuse {
namespace {
constexpr Duration kHeardAnew = std::chrono::milliseconds(50);  // ages are rounded on their way here
constexpr Duration kAgeUnit = std::chrono::milliseconds(10);
constexpr double kLevelUnit_db = 0.01;
}  // namespace

double ScanWatch::since_s(PhoneTime at) const {
  return newest_reason_ ? seconds(at - *newest_reason_) : std::numeric_limits<double>::infinity();
}

ScanWatch::Heard ScanWatch::brief(const ScanReading& reading) {
  const double level = std::clamp(std::round(reading.rss_dbm / kLevelUnit_db), -32768.0, 32767.0);
  const auto age = std::clamp<std::int64_t>(reading.age / kAgeUnit, 0, std::numeric_limits<std::uint16_t>::max());
  const std::uint64_t mixed = reading.bssid.value * 0x9e3779b97f4a7c15ull;  // Fibonacci hashing [Knuth 6.4]
  return {static_cast<std::uint32_t>(mixed >> 32), static_cast<std::int16_t>(level), static_cast<std::uint16_t>(age)};
}

// Levels of a living radio move by a decibel or more from scan to scan. A cache hands the same levels out again, but says so by
// their age; a recording claims that they are new.
void ScanWatch::hear(const RssScan& scan, BuildingPoint odometry) {
  for (const ScanReading& reading : scan.readings) {
    if (std::isfinite(reading.rss_dbm)) now_.push_back(brief(reading));
  }
  std::ranges::sort(now_, [](const Heard& a, const Heard& b) { return a.name != b.name ? a.name < b.name : a.age < b.age; });
  const auto [repeated, end] = std::ranges::unique(now_, {}, &Heard::name);
  now_.erase(repeated, end);
  int anew = 0, same = 0;
  auto before = last_.begin();
  for (const Heard& heard : now_) {
    while (before != last_.end() && before->name < heard.name) ++before;
    if (before == last_.end()) break;
    if (before->name != heard.name) continue;
    if (scan.time - kAgeUnit * heard.age <= last_at_ - kAgeUnit * before->age + kHeardAnew) continue;
    ++anew;
    same += heard.level == before->level;
  }
  const bool walked = distance_m(odometry, last_odometry_) >= settings_.walked_m;
  const bool copy = anew >= settings_.same_levels && same >= settings_.same_share * anew;
  if (!copy) copies_ = 0;
  else if (walked) ++copies_;
  if (copies_ >= settings_.copies) suspect_from(scan.time, Trick::kCopied);
  if (!copy || walked) last_odometry_ = odometry;
  std::swap(last_, now_);
  last_at_ = scan.time;
  now_.clear();
}

void ScanWatch::count_strong(int out_of_place, PhoneTime at) {
  const bool twice = std::min(out_of_place, strong_before_) >= settings_.strong_twice;
  if (out_of_place >= settings_.strong || twice) suspect_from(at, Trick::kOutOfPlace);
  strong_before_ = out_of_place;
}

void ScanWatch::compare(double misfit, Place elsewhere, PhoneTime at) {
  if (misfit < settings_.misfit) {
    ++agreed_;
    jumps_ = 0;
    return;
  }
  if (agreed_ < settings_.agreed) {  // the track has no standing yet
    agreed_ = 0;
    return;
  }
  const bool together = elsewhere.floor == jumped_to_.floor && distance_m(elsewhere.point, jumped_to_.point) <= settings_.together_m;
  jumps_ = jumps_ > 0 && !together ? 1 : jumps_ + 1;
  jumped_to_ = elsewhere;
  if (jumps_ >= settings_.jumps) suspect_from(at, Trick::kElsewhere);
}

}  // namespace wayfuse
