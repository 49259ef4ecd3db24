#include "server/pipeline/reading_gate.hpp"

#include <algorithm>

namespace wayfuse {
namespace {
constexpr Duration kSameReading = std::chrono::milliseconds(10);  // ages are rounded on their way here
constexpr Duration kMostAge = std::chrono::minutes(10);
constexpr std::size_t kMostRemembered = 4096;
}  // namespace

void ReadingGate::begin(PhoneTime time) {
  if (!began_) began_ = time;
}

bool ReadingGate::fresh(const ScanReading& reading, PhoneTime heard) const {
  if (settings_.all) return true;
  if (seconds(reading.age) > settings_.max_age_s) return false;
  if (began_ && heard < *began_) return false;
  if (!settings_.drop_repeats) return true;
  const auto last = last_heard_.find(reading.bssid);
  return last == last_heard_.end() || heard > last->second + kSameReading;
}

std::optional<ReadingGate::Fresh> ReadingGate::take(const RssScan& scan, RssScan& kept) {
  kept.time = scan.time;
  kept.readings.clear();
  Duration ages{0};
  Duration least_age = kMostAge;
  for (const ScanReading& reading : scan.readings) {
    if (reading.age < Duration{0} || reading.age > kMostAge) continue;
    if (!fresh(reading, scan.time - reading.age)) continue;
    kept.readings.push_back(reading);
    ages += reading.age;
    least_age = std::min(least_age, reading.age);
  }
  for (const ScanReading& reading : kept.readings) {
    PhoneTime& last = last_heard_[reading.bssid];
    last = std::max(last, scan.time - reading.age);
  }
  if (last_heard_.size() > kMostRemembered) forget(scan.time);
  if (kept.readings.empty()) return std::nullopt;
  if (settings_.all) return Fresh{scan.time, scan.time};
  const PhoneTime mean = scan.time - ages / static_cast<std::int64_t>(kept.readings.size()) + from_seconds(settings_.delay_s);
  return Fresh{std::min(mean, scan.time), scan.time - least_age};
}

std::string ReadingGate::why_not(const ScanReading& reading, PhoneTime heard) const {
  if (reading.age < Duration{0} || reading.age > kMostAge) return "its age is impossible";
  if (seconds(reading.age) > settings_.max_age_s) return "older than this pipeline takes";
  if (began_ && heard < *began_) return "heard before the walk began";
  return "told before: a copy out of the phone's cache";
}

void ReadingGate::forget(PhoneTime now) {
  std::erase_if(last_heard_, [&](const auto& entry) { return entry.second + std::chrono::seconds(60) < now; });
  if (last_heard_.size() > kMostRemembered) last_heard_.clear();
}

}  // namespace wayfuse
