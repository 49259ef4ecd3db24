#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Where a building's zone events are posted to.
struct WebhookRecord {
  std::uint64_t id = 0;                          ///< 0 = not stored yet; a number is never given twice
  std::string url;
  std::string secret;                            ///< 32 random bytes that sign the events
  std::vector<std::uint64_t> zones;              ///< only of these; empty = of all
  bool enabled = true;
  UnixTime created_at = {};
  bool operator==(const WebhookRecord&) const = default;
};

}  // namespace wayfuse
