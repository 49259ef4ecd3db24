#pragma once

#include <cstdint>
#include <string>

namespace wayfuse {

/// A part of a recorded survey walk, about to be stored.
struct WalkPartDraft {
  std::string idempotency_key;
  std::string walk;
  std::uint32_t part = 0;
  bool last = false;
  std::uint32_t scans = 0;
  std::string content;                   ///< the survey_walk message, CBOR
};

}  // namespace wayfuse
