#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/result.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// A transmitter's 48-bit address.
struct Bssid {
  std::uint64_t value = 0;
  auto operator<=>(const Bssid&) const = default;
  bool locally_administered() const { return (value >> 41) & 1; }
};
/// Lower case, colon separated.
std::string to_string(Bssid bssid);
/// Any case, separators `:`, `-` or none.
std::optional<Bssid> parse_bssid(std::string_view text);

/// One transmitter as heard. An access point missing from a scan is unknown, never a number.
struct ScanReading {
  Bssid bssid;
  double rss_dbm = 0.0;             ///< -120..0
  Duration age{0};                  ///< before the scan's time, 0..600 s: phones hand out caches
  std::uint16_t frequency_mhz = 0;  ///< channel centre; 0 = not told
  std::optional<double> range_m;        ///< time-of-flight distance, if ranging was done
  std::optional<double> range_sigma_m;  ///< its standard deviation
  bool operator==(const ScanReading&) const = default;
};

/// What the phone's operating system handed over in one go.
struct RssScan {
  PhoneTime time;                    ///< arrival; a reading was heard at `time - age`
  std::vector<ScanReading> readings;
  bool operator==(const RssScan&) const = default;
};

/// Leaves the `most` youngest readings, those of one age in their order: a phone in a dense place hands over more than a message takes, and
/// the youngest say most. Returns how many were left out; a scan of no more is not touched.
std::size_t keep_youngest(RssScan& scan, std::size_t most);

}  // namespace wayfuse
