#pragma once

#include <cstdint>
#include <string>

#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// A radio map about to be staged. What `content` means is the pipeline's matter; the store keeps it byte by byte.
struct RadioMapDraft {
  std::uint64_t survey_version = 0;      ///< of the survey it was built from
  std::string recipe;                    ///< how it was built (pipeline and settings, JSON), so that it can be built again
  UnixTime built_at;
  std::string content;
};

/// A stored radio map, without its content. It is never changed.
struct RadioMapRecord {
  std::uint64_t version = 0;             ///< ascending, never given twice
  std::uint64_t survey_version = 0;
  std::string recipe;
  UnixTime built_at;
  std::string sha256;                    ///< of the content, raw 32 bytes
  std::uint64_t bytes = 0;
  bool operator==(const RadioMapRecord&) const = default;
};

/// Who put a version in force, when and why.
struct Publication {
  enum class Act : std::uint8_t { kPromoted, kRolledBack };
  std::uint64_t id = 0;
  std::uint64_t version = 0;
  Act act = Act::kPromoted;
  UnixTime at;
  std::uint64_t by_key = 0;              ///< 0 = the server itself
  std::string reason;
  bool operator==(const Publication&) const = default;
};

/// A recorded walk with its truth, about to be stored; `content` is the SDK's recording.
struct QualityWalkDraft {
  std::string name;
  std::string device_model;
  UnixTime recorded_at;
  std::string content;
};
struct QualityWalkRecord {
  std::uint64_t id = 0;
  std::string name;
  std::string device_model;
  UnixTime recorded_at;
  std::string sha256;                    ///< of the content, raw 32 bytes
  std::uint64_t bytes = 0;
  bool operator==(const QualityWalkRecord&) const = default;
};

/// How a map did on a walk.
struct MapQuality {
  std::uint64_t version = 0;
  std::uint64_t walk_id = 0;
  UnixTime measured_at;
  std::uint64_t instants = 0;            ///< at which the error was taken, at least 1
  double mean_m = 0.0;
  double rmse_m = 0.0;
  double median_m = 0.0;
  double p90_m = 0.0;
  double floor_hit = 0.0;                ///< share, 0..1
  double in68 = 0.0;                     ///< share of truths inside the stated 68 % circle
  double in95 = 0.0;
  bool operator==(const MapQuality&) const = default;
};

}  // namespace wayfuse
