#pragma once

#include <cstdint>
#include <vector>

#include "wayfuse/proto/scan.hpp"

namespace wayfuse {

/// A scan as a session keeps it for a rewind: a quarter of its size, and back bit for bit. Phones list hundreds of readings, whole
/// decibels each; a scan with a reading that would lose something (a range, a level finer than a float) is kept as it is.
class KeptScan {
 public:
  explicit KeptScan(const RssScan& scan);

  RssScan scan() const;
  PhoneTime time() const { return time_; }
  std::size_t readings() const { return packed_.size() + whole_.size(); }
  std::size_t bytes() const { return packed_.size() * sizeof(Packed) + whole_.size() * sizeof(ScanReading); }

 private:
  struct Packed {
    std::uint64_t heard;             // address << 16 | channel
    float rss_dbm;
    std::uint32_t age_us;
  };
  PhoneTime time_;
  std::vector<Packed> packed_;
  std::vector<ScanReading> whole_;   // either all here or all there
};

}  // namespace wayfuse
