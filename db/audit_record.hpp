#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// One line of the audit: which key did or read what. Never a position, a token or a person [C19].
struct AuditRecord {
  std::uint64_t id = 0;                  ///< given by the store, ascending
  UnixTime at = {};
  std::uint64_t key_id = 0;              ///< 0 = nobody or the server itself
  BuildingId building = {};                 ///< 0 = none
  std::string action = {};                   ///< like `observe`, `keys.revoke`; 1..64 bytes
  std::string subject = {};                  ///< what it was done to, like `key 4`
  bool operator==(const AuditRecord&) const = default;
};

/// Which lines; all conditions given must fit.
struct AuditQuery {
  std::uint64_t after_id = 0;            ///< exclusive
  std::uint32_t most = 1000;
  std::optional<BuildingId> building = {};
  std::optional<std::uint64_t> key_id = {};
};

}  // namespace wayfuse
