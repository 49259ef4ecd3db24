#include "server/pipeline/scan_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wayfuse {
namespace {
constexpr Duration kHeardAnew = std::chrono::milliseconds(50);  // ages are rounded on their way here
}  // namespace

double ScanWatch::since_s(PhoneTime at) const {
  return newest_reason_ ? seconds(at - *newest_reason_) : std::numeric_limits<double>::infinity();
}

// Levels of a living radio move by a decibel or more from scan to scan. A cache hands the same levels out again, but says so by
// their age; a recording claims that they are new.
void ScanWatch::hear(const RssScan& scan, BuildingPoint odometry) {
  now_.clear();
  for (const ScanReading& reading : scan.readings) {
    if (std::isfinite(reading.rss_dbm)) now_.push_back({reading.bssid, reading.rss_dbm, scan.time - reading.age});
  }
  std::ranges::sort(now_, [](const Heard& a, const Heard& b) { return a.bssid != b.bssid ? a.bssid < b.bssid : a.at > b.at; });
  const auto [repeated, end] = std::ranges::unique(now_, {}, &Heard::bssid);
  now_.erase(repeated, end);
  int anew = 0, same = 0;
  auto before = last_.begin();
  for (const Heard& heard : now_) {
    while (before != last_.end() && before->bssid < heard.bssid) ++before;
    if (before == last_.end()) break;
    if (before->bssid != heard.bssid || heard.at <= before->at + kHeardAnew) continue;
    ++anew;
    same += heard.rss_dbm == before->rss_dbm;
  }
  const bool walked = distance_m(odometry, last_odometry_) >= settings_.walked_m;
  const bool copy = anew >= settings_.same_levels && same >= settings_.same_share * anew;
  if (!copy) copies_ = 0;
  else if (walked) ++copies_;
  if (copies_ >= settings_.copies) suspect_from(scan.time, Trick::kCopied);
  if (!copy || walked) last_odometry_ = odometry;
  std::swap(last_, now_);
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
