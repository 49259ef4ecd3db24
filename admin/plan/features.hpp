#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// A coordinate pair as a file has it: degrees, Mercator or plain metres.
struct RawPoint {
  double x = 0.0;
  double y = 0.0;
  bool operator==(const RawPoint&) const = default;
};
using RawLine = std::vector<RawPoint>;

/// One feature of a GeoJSON FeatureCollection (RFC 7946), no more of it than plans need.
struct Feature {
  std::string where;                               ///< for reports: `unit[3] 3f2a..`
  std::string id;                                  ///< top-level, or the properties' own
  std::map<std::string, std::string> properties;   ///< scalars as text; of IMDF's labels the first language
  std::vector<std::vector<RawLine>> polygons;      ///< rings as drawn, the repeated last point included
  std::vector<RawLine> lines;
  bool has_geometry = false;

  /// The first of these properties that is there and not empty, in lower case when `lower`.
  std::string property(std::initializer_list<const char*> names, bool lower = false) const;
};

struct FeatureCollection {
  std::vector<Feature> features;
  std::string crs;                                 ///< name of an old `crs` member; empty = none
};

/// `name` is what the features are called in reports. At most 100,000 features and 2,000,000 coordinates.
Result<FeatureCollection> read_features(std::string_view json, const std::string& name);

/// A zip archive's files by name (RFC-less, but IMDF's container): at most 64 files and 64 MiB unpacked.
Result<std::map<std::string, std::string>> unzip(std::string_view archive);
/// Such an archive of these files.
std::string zip(const std::map<std::string, std::string>& files);

}  // namespace wayfuse
