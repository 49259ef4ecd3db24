#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace wayfuse {

/// Everything that can be wrong with what somebody sent. Numbered and append-only: a number is never reused.
enum class FaultCode : std::uint16_t {
  kMalformed = 1,             ///< not parseable as the negotiated encoding
  kTooLarge = 2,              ///< a message, list, string or depth beyond its limit
  kMissingField = 3,          ///< a required field is absent
  kWrongType = 4,             ///< a field holds another type than the contract says
  kOutOfRange = 5,            ///< a number outside its range, not finite, or a count that does not fit
  kDuplicateField = 6,        ///< a map key stands twice
  kBadText = 7,               ///< not UTF-8, or control characters in a name
  kUnknownType = 8,           ///< a message type this version does not know
  kUnknownName = 9,           ///< a named part, setting, preset or enumerator that does not exist
  kUnsupportedVersion = 10,   ///< no common WebSocket subprotocol
  kNotAuthenticated = 20,     ///< no key, or a wrong one
  kNotAllowed = 21,           ///< the key's scope or building does not cover this
  kUnknownBuilding = 22,      ///< no such building, or not visible to this key (deliberately the same answer)
  kUnknownSession = 23,       ///< resume of a session the server no longer has
  kNotFound = 24,             ///< no such resource
  kHelloExpected = 30,        ///< the first message was not `hello`
  kUnexpectedMessage = 31,    ///< valid, but not in this role or state
  kSequenceGap = 32,          ///< samples skipped numbers: the client must resend from `applied_through + 1`
  kLate = 33,                 ///< older than the reorder window; dropped and counted
  kIdempotencyConflict = 34,  ///< the key was used before with another body
  kConflict = 35,             ///< the resource changed, or exists already
  kRateLimited = 40,          ///< too many messages or requests; retry after the stated time
  kOverloaded = 41,           ///< the server sheds load
  kDraining = 42,             ///< the server is going down; reconnect later
  kTimeout = 43,              ///< a deadline passed (hello, idle, write)
  kStorageFull = 50,          ///< the disk is full or read-only: nothing was stored, tracking goes on
  kStorageFailed = 51,        ///< the store failed; nothing was acknowledged
  kStoreBusy = 52,            ///< another process writes this database
  kStoreTooNew = 53,          ///< the database was written by a newer wayfuse
  kStoreCorrupt = 54,         ///< quick_check failed; quarantined
  kEmptyRadioMap = 60,        ///< the building has no fingerprints yet
  kNoKnownAccessPoint = 61,   ///< the scan holds no access point the map knows
  kNoBuildingMatches = 62,    ///< a session without a building id could not be resolved from its scans
  kInternal = 99,             ///< our own bug, caught at a boundary
};

/// What is wrong, where, and why, in words a person can act on.
struct Fault {
  FaultCode code = FaultCode::kInternal;
  std::string field;  ///< path into the message, like `samples[3].rss_dbm`; empty = the whole
  std::string cause;  ///< like `-312 is outside -120..0`

  bool operator==(const Fault&) const = default;
};

/// One row of the fault table: the single place that maps a code to its faces.
struct FaultFace {
  FaultCode code;
  std::string_view name;       ///< stable `snake_case` name on the wire
  int http_status;             ///< for the admin API
  std::uint16_t close_code;    ///< WebSocket close code when it ends the connection; 0 = the connection lives on
  std::string_view summary;    ///< one sentence for people
};

/// The whole table, ascending by code.
std::span<const FaultFace> fault_table();
/// The row of a code; an unknown number answers with the row of kInternal.
const FaultFace& face_of(FaultCode code);
/// `name: field: cause`, for logs and command lines.
std::string to_string(const Fault& fault);

}  // namespace wayfuse
