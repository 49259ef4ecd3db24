#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "wayfuse/proto/message.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/sdk/link.hpp"

namespace wayfuse {

struct ClientSettings {
  Role role = Role::kTrack;
  BuildingId building;                        ///< 0 = resolve from the first scans
  std::function<std::string()> token;         ///< asked before every connection; may be empty
  std::string device_model;
  std::string app;
  std::string pipeline;                       ///< empty = the building's own
  Duration batch_interval = std::chrono::seconds(1);    ///< how often the radio wakes
  Duration sample_ring = std::chrono::seconds(60);      ///< how long unacknowledged samples are kept
  Duration back_off_first = std::chrono::milliseconds(500);  ///< full jitter, doubling
  Duration back_off_most = std::chrono::seconds(30);
  Duration silence_most = std::chrono::seconds(60);     ///< without a frame: the link is dead
};

/// How it stands with the server.
enum class ClientState : std::uint8_t { kIdle, kConnecting, kGreeting, kStreaming, kBackingOff, kEnded };

/// What the application is told. Any may be left empty. Called on the link's thread of control.
struct ClientEvents {
  std::function<void(const Position&)> position;
  std::function<void(const NoFix&)> no_fix;
  std::function<void(const Welcome&)> welcomed;
  std::function<void(const SurveyAck&)> survey_stored;
  std::function<void(const Observation&)> observed;
  std::function<void(const FaultReport&)> fault;
  std::function<void(ClientState)> state_changed;
  /// Samples first..last were dropped before any server applied them (ring overrun or session not recovered).
  std::function<void(std::uint64_t first, std::uint64_t last)> samples_lost;
};

/// The phone's end of a session: connect, hello, stream, back off, resume, replay.
///
/// Thread: one; see Link. Nothing is sent twice with another number, nothing is forgotten before it is acknowledged.
class Client {
 public:
  using LinkFactory = std::function<std::unique_ptr<Link>()>;
  Client(ClientSettings settings, ClientEvents events, LinkFactory links, Scheduler& scheduler, Random random);
  ~Client();

  void start();
  /// Numbers and keeps the sample; it goes out with the next batch. A value that breaks the limits is refused here.
  Result<void> send(SampleBody sample);
  /// Survey role: queues the batch until it is acknowledged. Full queue = kTooLarge.
  Result<void> upload(SurveyBatch batch);
  Result<void> subscribe(Subscribe subscription);
  /// Says goodbye and closes.
  void stop();

  ClientState state() const;
  std::uint64_t last_sequence() const;
  std::uint64_t acked_through() const;
  std::size_t uploads_waiting() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace wayfuse
