#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "wayfuse/proto/message.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/sdk/link.hpp"

namespace wayfuse {

/// What a surveyor sends up; durable when acknowledged.
using SurveyUpload = std::variant<SurveyBatch, SurveyWalk>;

struct ClientSettings {
  Role role = Role::kTrack;
  BuildingId building;                        ///< 0 = resolve from the first scans (track only)
  std::function<std::string()> token;         ///< asked before every connection and before the last one expires; must not throw
  std::string device_model;
  std::string app;
  std::string pipeline;                       ///< empty = the building's own
  Duration batch_interval = std::chrono::seconds(1);    ///< how often the radio wakes
  Duration rest_interval = std::chrono::seconds(5);     ///< ... while every waiting sample says "at rest"
  Duration sample_ring = std::chrono::seconds(60);      ///< how long unacknowledged samples are kept; Welcome may raise it to 5 min
  std::size_t sample_bytes_most = 4u << 20;   ///< memory for them, whatever their age
  std::size_t uploads_most = 256;             ///< survey batches waiting for their acknowledgement
  Duration upload_patience = std::chrono::seconds(30);  ///< without an answer: the batch goes out again, same key
  Duration back_off_first = std::chrono::milliseconds(500);  ///< full jitter, doubling
  Duration back_off_most = std::chrono::seconds(30);
  Duration connect_most = std::chrono::seconds(30);     ///< name look-up, TCP, TLS and upgrade together
  Duration greeting_most = std::chrono::seconds(10);    ///< from hello to welcome
  Duration silence_most = std::chrono::seconds(60);     ///< without a sign of life: the link is dead
  Duration ack_most = std::chrono::seconds(20);         ///< samples sent and none acknowledged: the link is sick
  int token_refusals_most = 3;                ///< refused so often in a row, the client ends
};

/// How it stands with the server.
enum class ClientState : std::uint8_t { kIdle, kConnecting, kGreeting, kStreaming, kBackingOff, kEnded };

/// What the application is told. Any may be left empty. Called on the link's thread of control; the client may be called
/// from inside.
struct ClientEvents {
  std::function<void(const Position&)> position;
  std::function<void(const NoFix&)> no_fix;
  std::function<void(const Welcome&)> welcomed;
  std::function<void(const SurveyAck&)> survey_stored;
  std::function<void(const Observation&)> observed;
  std::function<void(const ZoneEvent&)> zone_crossed;
  std::function<void(const ScanHint&)> scan_hint;
  std::function<void(const ClockAnswer&)> clock;
  /// What the server refused, and frames of the server that were refused. An upload refused for good is dropped after this.
  std::function<void(const FaultReport&)> fault;
  std::function<void(ClientState)> state_changed;
  /// Samples first..last were dropped before any server applied them, or before the client could learn that one had (ring
  /// overrun, session not recovered).
  std::function<void(std::uint64_t first, std::uint64_t last)> samples_lost;
  /// A connection ended; the reason is for people.
  std::function<void(std::string_view reason)> disconnected;
};

/// The phone's end of a session: connect, hello, stream, back off, resume, replay.
///
/// Samples are numbered from 1 as they come. None changes its number within a session, and none is forgotten before it is
/// acknowledged or reported lost; where the server could not recover a session, all that is kept goes into the new one.
/// Thread: one; see Link. Memory: bounded by `sample_bytes_most` and `uploads_most` x 64 KiB.
class Client {
 public:
  using LinkFactory = std::function<std::unique_ptr<Link>()>;
  Client(ClientSettings settings, ClientEvents events, LinkFactory links, Scheduler& scheduler, Random random);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Connects; also again after the end.
  void start();
  /// Track role: numbers and keeps the sample; it goes out with the next batch. A value that breaks the limits is refused;
  /// of a longer scan than a message takes the youngest readings are sent (keep_youngest).
  Result<void> send(SampleBody sample);
  /// Survey role: queues a batch, or a part of a walk, until it is acknowledged. Full queue = kTooLarge.
  Result<void> upload(SurveyUpload upload);
  /// Observe role: what to see; remembered over reconnects.
  Result<void> subscribe(Subscribe subscription);
  /// The way to the network changed (Wi-Fi to cellular, back from a tunnel): reconnects now instead of waiting.
  void network_changed();
  /// Sends what waits, says goodbye and closes.
  void stop();

  ClientState state() const;
  std::uint64_t last_sequence() const;
  /// All up to here were applied by a server or reported lost.
  std::uint64_t acked_through() const;
  std::size_t uploads_waiting() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace wayfuse
