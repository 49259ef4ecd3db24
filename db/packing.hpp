#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/proto/scan.hpp"

/// How lists too small and too many for rows of their own lie in blobs. Layouts: db/README.md. Lossless: what is unpacked
/// equals what was packed, bit by bit.
namespace wayfuse {

/// Appends to a blob, little endian.
class Packer {
 public:
  void u8(std::uint8_t value) { bytes_.push_back(static_cast<char>(value)); }
  void u16(std::uint16_t value) { little_endian(value, 2); }
  void u32(std::uint32_t value) { little_endian(value, 4); }
  void u48(std::uint64_t value) { little_endian(value, 6); }
  void u64(std::uint64_t value) { little_endian(value, 8); }
  void f64(double value);
  /// Length first, so that no two sequences of texts look alike.
  void text(std::string_view value);
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  const std::string& bytes() const { return bytes_; }
  std::string take() { return std::move(bytes_); }

 private:
  void little_endian(std::uint64_t value, int bytes);
  std::string bytes_;
};

/// A fault names the reading and its field below `path`, like `points[2].scans[0].readings[5].rss_dbm`.
Result<std::string> pack_readings(const std::vector<ScanReading>& readings, std::string_view path);
/// kStoreCorrupt when the blob is not what pack_readings() makes.
Result<std::vector<ScanReading>> unpack_readings(std::string_view blob);

std::string pack_polygons(const std::vector<Polygon>& polygons);
Result<std::vector<Polygon>> unpack_polygons(std::string_view blob);

}  // namespace wayfuse
