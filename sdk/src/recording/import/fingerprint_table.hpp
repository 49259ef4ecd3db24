#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// One scan of a fingerprint collection, with where it was taken. Only what was heard stands in it.
struct TabledScan {
  struct Heard {
    std::uint16_t access_point = 0;  ///< column
    double rss_dbm = 0.0;
  };
  std::vector<Heard> heard;  ///< ascending columns
  BuildingPoint point;       ///< in the units of the file
  FloorOrdinal floor;
  int building = 0;
  int user = 0;  ///< 0 = not told
  int phone = 0;
  std::int64_t unix_s = 0;
};

/// A fingerprint collection: rows of scans over fixed columns of access points.
struct FingerprintTable {
  std::size_t access_points = 0;
  std::vector<TabledScan> scans;
  std::vector<std::string> names;  ///< of the access points; empty = not told
};

/// Numbers the access points of `table` as `like` does, by name; false = other names, and nothing is changed.
bool number_like(const FingerprintTable& like, FingerprintTable& table);

/// How UJIIndoorLoc's coordinates are read. They are Web-Mercator units at latitude 39.99 degrees: true metres are 0.766 of
/// them. Publications take them for metres.
inline constexpr double kUjiMetresPerUnit = 0.7660;

/// A row that does not serve.
struct BadRow {
  int line = 0;
  std::string column;        ///< its name; empty = the row as a whole
  std::string cause;
};

/// UJIIndoorLoc: header; access points WAP..., LONGITUDE, LATITUDE, FLOOR, BUILDINGID, ..., TIMESTAMP, in any order and case, found by
/// name. Not heard: 100, nothing, `nan`; also 0, or a level of -100 and below, that fills more than half of all cells. Faults
/// name file, line and column; rows that do not serve are left out and named in `bad`, where there is one.
Result<FingerprintTable> read_uji(const std::string& file, std::vector<BadRow>* bad = nullptr);

}  // namespace wayfuse
