#pragma once

#include <cstdint>
#include <string>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// A building was backed up or verified. A backup that was taken: whether its file arrived, only its taker knows.
struct UpkeepRecord {
  enum class Kind : std::uint8_t { kBackup = 0, kVerification = 1 };
  BuildingId building = {};
  Kind kind = Kind::kBackup;
  UnixTime at = {};
  std::uint64_t key_id = 0;            ///< who asked for it
  std::uint64_t survey_version = 0;    ///< of the building then
  std::uint64_t bytes = 0;             ///< of the backup; 0 of a verification
  std::string finding = {};            ///< what a verification found first; empty = sound; at most 1024 bytes
  bool operator==(const UpkeepRecord&) const = default;
};

}  // namespace wayfuse
