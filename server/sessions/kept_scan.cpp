#include "server/sessions/kept_scan.hpp"

#include <algorithm>
#include <limits>

namespace wayfuse {
namespace {

bool fits(const ScanReading& reading) {
  return !reading.range_m && !reading.range_sigma_m && reading.bssid.value >> 48 == 0 &&
         static_cast<double>(static_cast<float>(reading.rss_dbm)) == reading.rss_dbm && reading.age.count() >= 0 &&
         reading.age.count() <= std::numeric_limits<std::uint32_t>::max();
}

}  // namespace

KeptScan::KeptScan(const RssScan& scan) : time_(scan.time) {
  if (!std::ranges::all_of(scan.readings, fits)) {
    whole_ = scan.readings;
    return;
  }
  packed_.reserve(scan.readings.size());
  for (const ScanReading& reading : scan.readings) {
    packed_.push_back({reading.bssid.value << 16 | reading.frequency_mhz, static_cast<float>(reading.rss_dbm),
                       static_cast<std::uint32_t>(reading.age.count())});
  }
}

RssScan KeptScan::scan() const {
  RssScan scan{time_, whole_};
  scan.readings.reserve(readings());
  for (const Packed& each : packed_) {
    scan.readings.push_back({Bssid{each.heard >> 16}, static_cast<double>(each.rss_dbm), Duration{each.age_us},
                             static_cast<std::uint16_t>(each.heard & 0xffffu), std::nullopt, std::nullopt});
  }
  return scan;
}

}  // namespace wayfuse
