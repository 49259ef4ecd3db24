#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "wayfuse/proto/fault.hpp"
#include "wayfuse/proto/fingerprint.hpp"
#include "wayfuse/proto/fix.hpp"
#include "wayfuse/proto/motion.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/scan.hpp"
#include "wayfuse/proto/time.hpp"

/// Protocol v1: every sentence phone and server say to each other. Encoded by codec.hpp, specified in proto/README.md.
namespace wayfuse {

/// What the connection is for.
enum class Role : std::uint8_t { kTrack, kSurvey, kObserve };

/// Limits of v1, the same on both sides [SAFETY C7, C8].
struct Limits {
  static constexpr std::size_t kMessageBytes = 64 * 1024;
  static constexpr std::size_t kReadingsPerScan = 512;
  static constexpr std::size_t kSamplesPerBatch = 1024;
  static constexpr std::size_t kPointsPerBatch = 256;
  static constexpr std::size_t kScansPerPoint = 64;
  static constexpr std::size_t kMarksPerWalkPart = 256;
  static constexpr std::size_t kMotionPerWalkPart = 1024;
  static constexpr std::size_t kScansPerWalkPart = 256;
  static constexpr std::size_t kObservedPerMessage = 64;   ///< the server splits larger views
  static constexpr std::size_t kFloorsPerMessage = 64;
  static constexpr std::size_t kNamesPerFilter = 256;
  static constexpr std::size_t kStringBytes = 256;
  static constexpr std::size_t kCauseBytes = 1024;         ///< a fault's cause may list what is known
  static constexpr std::size_t kKeyBytes = 64;             ///< idempotency keys, session names
  static constexpr std::size_t kTicketBytes = 32 * 1024;   ///< sealed, before base64
  static constexpr int kDepth = 8;
  /// Every integer on the wire is exact in a double, so that JavaScript reads it: ids, epochs, versions, sequences, times.
  static constexpr std::int64_t kLargestInteger = (std::int64_t{1} << 53) - 1;
};

// ---------------------------------------------------------------- client -> server

/// Asks to go on with an earlier session.
///
/// The session is whole (`recovered`) if the server still has it and applied everything the client no longer keeps, so
/// that `acked_through` is not beyond what was applied. Otherwise a new session begins at `acked_through`: numbers go on
/// from there, and what the client still keeps is sent and applied.
struct Resume {
  std::string session;             ///< as given in `welcome`
  std::uint64_t epoch = 0;         ///< of the server that gave it
  std::uint64_t acked_through = 0; ///< highest sample number the client knows as applied
  std::string ticket;              ///< newest sealed ticket, bytes; empty = none. Lets another server go on with the session
  bool operator==(const Resume&) const = default;
};

/// First message on every connection.
struct Hello {
  Role role = Role::kTrack;
  BuildingId building;             ///< 0 = resolve from the first scans (track only)
  std::string token;               ///< key or session token, where the upgrade request carried no Authorization header
  std::string device_model;        ///< model, never an address or a person
  std::string app;                 ///< name/version of the application, for operators
  std::string pipeline;            ///< empty = the building's own; otherwise a preset to compare
  PhoneTime phone_time;            ///< when this was sent
  std::optional<Resume> resume;
  bool operator==(const Hello&) const = default;
};

using SampleBody = std::variant<MotionReport, RssScan, GnssFix>;

/// One numbered piece of evidence. Numbers start at 1 in a session and have no gap.
struct Sample {
  std::uint64_t sequence = 0;
  SampleBody body;
  bool operator==(const Sample&) const = default;
};

/// What happened on the phone since the last batch; consecutive numbers.
struct SampleBatch {
  std::vector<Sample> samples;
  bool operator==(const SampleBatch&) const = default;
};

/// Reference points, stored all or none. Sent again under the same key it is answered again, not stored again [C18].
struct SurveyBatch {
  std::string idempotency_key;     ///< 1..64 characters, [A-Za-z0-9._-]
  std::vector<ReferencePoint> points;
  bool operator==(const SurveyBatch&) const = default;
};

/// The surveyor stood here at that moment of a walk.
struct WayPoint {
  PhoneTime time;
  Place place;
  double sigma_m = 0.0;             ///< how well the surveyor knew the place
  bool operator==(const WayPoint&) const = default;
};

/// A survey walk as it was recorded: marks, the motion between them, and scans at their own times. The server places the
/// scans. Long walks go up in parts 0, 1, ..; each part has its own idempotency key and is durable when acknowledged, and the
/// scans are placed when the `last` part and all before it are there.
struct SurveyWalk {
  std::string idempotency_key;      ///< of this part
  std::string walk;                 ///< names the walk, the same in all parts; unique in the building
  std::uint32_t part = 0;           ///< 0..9999
  bool last = true;
  std::string device_model;
  UnixTime wall_time;               ///< the same instant on two clocks: `wall_time` and `phone_time`
  PhoneTime phone_time;
  std::vector<WayPoint> marks;      ///< ascending in time, as are the next two
  std::vector<MotionReport> motion;
  std::vector<RssScan> scans;
  bool operator==(const SurveyWalk&) const = default;
};

/// What an observer wants to see. A later one replaces the earlier.
struct Subscribe {
  std::vector<FloorOrdinal> floors; ///< empty = all
  std::vector<std::string> tracked; ///< public session names; empty = all
  Duration min_interval{0};         ///< of one tracked phone; the newest wins in between
  bool positions = true;
  bool zone_events = false;
  bool operator==(const Subscribe&) const = default;
};

/// A fresh token before the old one expires; the session goes on. Answered by TokenAccepted or a fault.
struct TokenRefresh {
  std::string token;
  bool operator==(const TokenRefresh&) const = default;
};

/// Asks what time it is there; also tells a live application from a socket that merely answers pings.
struct ClockProbe {
  PhoneTime phone_time;             ///< when this was sent
  bool operator==(const ClockProbe&) const = default;
};

/// The client leaves for good: the session ends.
struct Goodbye {
  std::string reason;
  bool operator==(const Goodbye&) const = default;
};

// ---------------------------------------------------------------- server -> client

/// A floor's label for people.
struct FloorName {
  FloorOrdinal floor;
  std::string label;
  bool operator==(const FloorName&) const = default;
};

/// Answer to Hello. Sent again in the same session whenever what it says has changed: the building was resolved, a new radio
/// map or pipeline came into force.
struct Welcome {
  std::string session;             ///< secret name for a later resume
  std::string tracked;             ///< public name, as observers see it; resumes nothing
  std::uint64_t epoch = 0;         ///< changes when the server lost its sessions
  std::uint64_t applied_through = 0;  ///< the next sample must be this plus one; 0 in a session never resumed
  bool recovered = false;          ///< on resume: the session is whole; otherwise it starts anew at `acked_through`
  BuildingId building;             ///< 0 = not resolved yet
  std::string building_name;
  std::vector<FloorName> floors;   ///< ascending
  std::optional<Georeference> georeference;
  MagneticField magnetic_field;
  std::string pipeline;            ///< in force
  std::uint64_t radio_map_version = 0;
  UnixTime server_wall_time;
  Duration keep_alive{0};          ///< the server pings this often
  Duration sample_ring{0};         ///< keep unacknowledged samples this long
  Duration token_expires_in{0};    ///< 0 = it does not
  bool is_recorded = false;        ///< an operator has what this session sends written down, for a while
  bool operator==(const Welcome&) const = default;
};

/// Samples up to `through` are applied; the client may forget them.
struct Ack {
  std::uint64_t epoch = 0;
  std::uint64_t through = 0;
  bool operator==(const Ack&) const = default;
};

/// The batch or walk part is durable: said only after COMMIT.
struct SurveyAck {
  std::string idempotency_key;
  std::uint32_t stored = 0;        ///< points (of a walk: scans) now in the store by it
  std::uint64_t survey_version = 0;   ///< of the survey, after it
  bool operator==(const SurveyAck&) const = default;
};

/// A fused position of this session.
struct Position {
  FusedPosition position;
  std::uint64_t applied_through = 0;
  bool operator==(const Position&) const = default;
};

/// Why there is no position now [C14].
struct NoFix {
  PhoneTime at;
  Fault reason;
  bool operator==(const NoFix&) const = default;
};

/// One tracked phone as an observer sees it. The name is the session's public one, not the one that resumes it.
struct Observed {
  std::string tracked;
  FusedPosition position;
  UnixTime received_at;
  bool gone = false;               ///< the session ended; the position is its last
  bool operator==(const Observed&) const = default;
};
struct Observation {
  std::vector<Observed> tracked;   ///< at most Limits::kObservedPerMessage
  bool operator==(const Observation&) const = default;
};

/// A tracked phone crossed a zone's boundary, beyond its tolerances.
enum class ZoneTransition : std::uint8_t { kEntered, kLeft };
struct ZoneEvent {
  std::string tracked;
  std::string zone;                ///< its id
  std::string zone_name;
  ZoneTransition transition = ZoneTransition::kEntered;
  UnixTime at;
  FloorOrdinal floor;
  double probability = 0.0;        ///< mass of the position inside the zone
  std::string id;                  ///< names this event on this server
  std::string retracts;            ///< the earlier event that this one takes back: the position was corrected; empty = none
  bool operator==(const ZoneEvent&) const = default;
};

/// The fresh token is in force.
struct TokenAccepted {
  Duration expires_in{0};          ///< 0 = it does not
  bool operator==(const TokenAccepted&) const = default;
};

/// Answer to ClockProbe: the server's wall clock between receiving and answering.
struct ClockAnswer {
  PhoneTime phone_time;            ///< as asked
  UnixTime server_wall_time;
  bool operator==(const ClockAnswer&) const = default;
};

/// How often scans would help now; the application keeps its platform's limits.
struct ScanHint {
  Duration interval{0};            ///< wished between scans; 0 = none needed for now (at rest, position is good)
  bool ranging = false;            ///< time-of-flight ranging would help
  std::string reason;
  bool operator==(const ScanHint&) const = default;
};

/// The session's state sealed by the server: opaque, for Resume on this or another server.
struct Ticket {
  std::string sealed;              ///< bytes
  std::uint64_t applied_through = 0;
  Duration expires_in{0};
  bool operator==(const Ticket&) const = default;
};

/// Something was wrong; whether the connection lives on is the fault table's word.
struct FaultReport {
  Fault fault;
  std::uint64_t sequence = 0;      ///< the sample concerned; 0 = none
  std::string idempotency_key;     ///< the survey batch concerned; empty = none
  Duration retry_after{0};         ///< 0 = not by itself
  bool operator==(const FaultReport&) const = default;
};

/// The server drains: reconnect somewhere between now and `within`, at random [C20].
struct GoAway {
  Duration within{0};
  std::string reason;
  bool operator==(const GoAway&) const = default;
};

using ClientMessage = std::variant<Hello, SampleBatch, SurveyBatch, SurveyWalk, Subscribe, TokenRefresh, ClockProbe, Goodbye>;
using ServerMessage = std::variant<Welcome, Ack, SurveyAck, Position, NoFix, Observation, ZoneEvent, TokenAccepted, ClockAnswer,
                                   ScanHint, Ticket, FaultReport, GoAway>;

}  // namespace wayfuse
