#include "wayfuse/proto/scan_splitter.hpp"

#include <algorithm>

namespace wayfuse {

std::vector<HeardTogether> ScanSplitter::split(const RssScan& scan) {
  constexpr Duration kTogether = std::chrono::seconds(2);
  constexpr Duration kSameReading = std::chrono::milliseconds(10);  // handed out again, its age rounded anew
  std::vector<ScanReading> readings;
  for (const ScanReading& reading : scan.readings) {
    const PhoneTime heard = scan.time - reading.age;
    const auto [last, first_time] = heard_.try_emplace(reading.bssid, heard);
    if (!first_time && heard <= last->second + kSameReading) continue;
    last->second = heard;
    readings.push_back(reading);
  }
  std::stable_sort(readings.begin(), readings.end(), [](const auto& a, const auto& b) { return a.age < b.age; });
  std::vector<HeardTogether> groups;
  for (std::size_t begin = 0, end; begin < readings.size(); begin = end) {
    const Duration newest = readings[begin].age;
    HeardTogether group{{scan.time - newest, {}}, {}};
    for (end = begin; end < readings.size() && readings[end].age - newest <= kTogether; ++end) {
      group.scan.readings.push_back(readings[end]);
      group.scan.readings.back().age -= newest;
    }
    group.middle = scan.time - (newest + readings[end - 1].age) / 2;
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace wayfuse
