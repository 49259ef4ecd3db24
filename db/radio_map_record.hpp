#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Whether a new map comes into force by itself, or by an operator's word alone.
enum class PublicationPolicy : std::uint8_t { kAutomatic, kReviewed };

/// A radio map about to be staged. What `content` means is the caller's matter; the store keeps it byte by byte.
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

/// With its content: the recording as it was uploaded.
struct StoredQualityWalk {
  QualityWalkRecord record;
  std::string content;
};

/// How a map did on a walk.
struct MapQuality {
  std::uint64_t version = 0;
  std::uint64_t walk_id = 0;
  UnixTime measured_at;
  std::uint64_t instants = 0;            ///< answered; all figures below are over these
  double mean_m = 0.0;
  double rmse_m = 0.0;
  double median_m = 0.0;
  double p90_m = 0.0;
  double floor_hit = 0.0;                ///< share, 0..1
  double in68 = 0.0;                     ///< share of truths inside the stated 68 % circle
  double in95 = 0.0;
  std::uint64_t asked = 0;               ///< instants with truth, answered or not; at least 1
  std::string measured_with;             ///< the pipeline: name and hash of its settings; a change makes the figures old
  std::vector<float> error_quantiles_m = {};  ///< 0 %, 1 %, .. 100 %; empty without an answer
  bool operator==(const MapQuality&) const = default;
};

/// Walks together, weighted by their instants.
struct PooledQuality {
  std::uint64_t walks = 0;
  std::uint64_t asked = 0;
  std::uint64_t instants = 0;
  double mean_m = 0.0;
  double median_m = 0.0;
  double p90_m = 0.0;
  double floor_hit = 0.0;
  double in68 = 0.0;
  double in95 = 0.0;
  std::vector<float> error_quantiles_m;  ///< of all instants, each walk's quantiles standing for its own in equal parts
};
PooledQuality pool(std::span<const MapQuality> walks);

}  // namespace wayfuse
