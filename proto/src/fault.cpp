#include "wayfuse/proto/fault.hpp"

#include <algorithm>
#include <array>

namespace wayfuse {
namespace {

using enum FaultCode;

// Close codes: 1002 protocol error, 1003 unsupported data, 1008 policy, 1009 too big, 1011 server error, 1012 restart,
// 1013 try again [RFC 6455 and its IANA registry].
constexpr std::array kTable = {
    FaultFace{kMalformed, "malformed", 400, 1003, "The message is not valid in the negotiated encoding."},
    FaultFace{kTooLarge, "too_large", 413, 1009, "A message, list, string or nesting is beyond its limit."},
    FaultFace{kMissingField, "missing_field", 422, 0, "A required field is absent."},
    FaultFace{kWrongType, "wrong_type", 422, 0, "A field holds another type than the contract says."},
    FaultFace{kOutOfRange, "out_of_range", 422, 0, "A number is outside its range or not finite."},
    FaultFace{kDuplicateField, "duplicate_field", 400, 1003, "A key stands twice in one map."},
    FaultFace{kBadText, "bad_text", 422, 0, "A text is not UTF-8 or holds control characters."},
    FaultFace{kUnknownType, "unknown_type", 400, 0, "This version does not know that message type."},
    FaultFace{kUnknownName, "unknown_name", 422, 0, "No such part, setting, preset or choice."},
    FaultFace{kUnsupportedVersion, "unsupported_version", 400, 1002, "No common protocol version."},
    FaultFace{kNotAuthenticated, "not_authenticated", 401, 1008, "No key was given, or it is not valid."},
    FaultFace{kNotAllowed, "not_allowed", 403, 1008, "The key does not cover this."},
    FaultFace{kUnknownBuilding, "unknown_building", 404, 1008, "There is no such building for this key."},
    FaultFace{kUnknownSession, "unknown_session", 404, 0, "The session to resume is not known; a new one was begun."},
    FaultFace{kNotFound, "not_found", 404, 0, "There is no such resource."},
    FaultFace{kHelloExpected, "hello_expected", 400, 1002, "The first message must be hello."},
    FaultFace{kUnexpectedMessage, "unexpected_message", 409, 0, "The message does not fit this role or moment."},
    FaultFace{kSequenceGap, "sequence_gap", 409, 0, "Sample numbers have a gap; send again from applied_through + 1."},
    FaultFace{kLate, "late", 409, 0, "The sample is older than the reorder window and was dropped."},
    FaultFace{kIdempotencyConflict, "idempotency_conflict", 409, 0, "The key was used before with another body."},
    FaultFace{kConflict, "conflict", 409, 0, "The resource exists already or has changed."},
    FaultFace{kRateLimited, "rate_limited", 429, 0, "Too many messages or requests; wait and try again."},
    FaultFace{kOverloaded, "overloaded", 503, 1013, "The server sheds load; try again later."},
    FaultFace{kDraining, "draining", 503, 1012, "The server is going down; reconnect later."},
    FaultFace{kTimeout, "timeout", 408, 1008, "A deadline passed."},
    FaultFace{kStorageFull, "storage_full", 507, 0, "The disk is full or read-only; nothing was stored."},
    FaultFace{kStorageFailed, "storage_failed", 500, 0, "The store failed; nothing was acknowledged."},
    FaultFace{kStoreBusy, "store_busy", 503, 0, "Another process writes this database."},
    FaultFace{kStoreTooNew, "store_too_new", 500, 0, "The database was written by a newer wayfuse."},
    FaultFace{kStoreCorrupt, "store_corrupt", 500, 0, "The database failed its check and is quarantined."},
    FaultFace{kEmptyRadioMap, "empty_radio_map", 409, 0, "The building has no fingerprints yet."},
    FaultFace{kNoKnownAccessPoint, "no_known_access_point", 404, 0, "No access point heard is on the map."},
    FaultFace{kNoBuildingMatches, "no_building_matches", 404, 0, "The access points heard match no building clearly."},
    FaultFace{kInternal, "internal", 500, 1011, "A bug of ours; it was logged."},
};

}  // namespace

std::span<const FaultFace> fault_table() { return kTable; }

const FaultFace& face_of(FaultCode code) {
  // The algorithm without ranges: WebAssembly's and older phones' libc++ have none.
  const auto row = std::find_if(kTable.begin(), kTable.end(), [code](const FaultFace& face) { return face.code == code; });
  return row != kTable.end() ? *row : kTable.back();
}

std::string to_string(const Fault& fault) {
  std::string text{face_of(fault.code).name};
  if (!fault.field.empty()) text += ": " + fault.field;
  if (!fault.cause.empty()) text += ": " + fault.cause;
  return text;
}

}  // namespace wayfuse
