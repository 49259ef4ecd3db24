#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// What a phone holds instead of a key [SAFETY C1]: it may track, in one building or where its key may, for 15 minutes at most.
struct SessionToken {
  static constexpr Duration kLifeMost = std::chrono::minutes(15);

  std::uint64_t key_id = 0;     ///< the key that asked for it; revoked with it
  BuildingId building;          ///< 0 = all
  UnixTime expires_at;
  bool operator==(const SessionToken&) const = default;
};

/// `ws_` and base64url of the fields and their BLAKE2b-256, keyed with the server's secret. Nothing is stored.
std::string seal(const SessionToken& token, std::string_view secret);
/// The token if this server sealed it, whether or not it has expired; compared in constant time.
std::optional<SessionToken> unseal(std::string_view text, std::string_view secret);
/// Whether the text is meant as a session token.
bool looks_like_session_token(std::string_view text);

}  // namespace wayfuse
