#pragma once

#include <optional>
#include <string>

#include "wayfuse/proto/scan.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// What live traffic says of an access point, held against the survey.
enum class AccessPointState : std::uint8_t { kOk, kVanished, kMoved, kPowerChanged, kNew };
/// What the operator says about that: believe the traffic, or decide once and for all.
enum class AccessPointTrust : std::uint8_t { kAuto, kAlways, kNever };

std::string_view to_string(AccessPointState state);   ///< `ok`, `vanished`, `moved`, `power_changed`, `new`
std::string_view to_string(AccessPointTrust trust);   ///< `auto`, `always`, `never`

/// The newest verdict on one access point. No phone's position, no session's name.
struct AccessPointRecord {
  Bssid bssid;
  AccessPointTrust trust = AccessPointTrust::kAuto;
  AccessPointState state = AccessPointState::kOk;
  std::string reason;                    ///< in words, with the counts it rests on
  std::uint64_t heard_sessions = 0;
  std::optional<UnixTime> last_heard_at;
  std::optional<double> distance_m;      ///< moved: how far, between the two places where it was strongest
  std::optional<double> change_db;       ///< mean of heard minus surveyed, the phones' own offsets taken out
  UnixTime decided_at;
  bool operator==(const AccessPointRecord&) const = default;

  /// Whether its readings stay out of the likelihood.
  bool distrusted() const {
    if (trust != AccessPointTrust::kAuto) return trust == AccessPointTrust::kNever;
    return state == AccessPointState::kVanished || state == AccessPointState::kMoved || state == AccessPointState::kPowerChanged;
  }
};

}  // namespace wayfuse
