#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// What the key behind a connection may do here. Net makes it from the principal it authenticated.
struct Rights {
  std::uint64_t key_id = 0;  ///< a session is resumed only by the key that began it
  bool track = false;
  bool survey = false;
  bool observe = false;
  BuildingId building;                 ///< 0 = all
  std::optional<UnixTime> expires_at;  ///< then a fresh token must have come [C1]
  bool coarse = false;                 ///< observes zones, never positions [C19]

  bool may(Role role) const { return role == Role::kTrack ? track : role == Role::kSurvey ? survey : observe; }
  bool covers(BuildingId asked) const { return building.value == 0 || building == asked; }
  bool operator==(const Rights&) const = default;
};

/// Looks a bearer token up: kNotAuthenticated if there is no such key.
using Authenticate = std::function<Result<Rights>(std::string_view token)>;

/// Brings a task back to the connection's strand; from any thread.
using Post = std::function<void(std::function<void()>)>;

/// Where a session's answers go. The implementation bounds and conflates: positions are replaced by newer ones, acks and
/// faults are never dropped [SAFETY C12].
class SessionOutput {
 public:
  virtual ~SessionOutput() = default;
  virtual void send(const ServerMessage& message) = 0;
  /// Something is still waiting to be written: what can be left out should be left out.
  virtual bool congested() const = 0;
  /// Says the fault, then closes with its close code (1008 where the table has none).
  virtual void close(const Fault& reason) = 0;
  /// The conversation is over and all went well: flushes, then closes with 1000.
  virtual void finish() = 0;
};

/// Protocol without sockets: one connection's conversation.
///
/// Thread: confined to the connection's strand; answers from the store are posted back to it.
class Conversation {
 public:
  virtual ~Conversation() = default;
  virtual void receive(ClientMessage message) = 0;
  /// A frame that did not decode.
  virtual void receive(const Fault& malformed) = 0;
  /// Called about once in tick_interval(): deadlines, takeover, conflated observations.
  virtual void tick() = 0;
  virtual Duration tick_interval() const = 0;
  /// The connection is gone; a tracking session stays resumable.
  virtual void disconnected() = 0;
};

struct SessionWorld;

/// Begins a conversation that waits for `hello`. `rights` come from the upgrade request; without them the hello's token
/// is looked up. The world and the output must outlive the conversation.
std::shared_ptr<Conversation> begin_conversation(SessionWorld& world, SessionOutput& output, Post post,
                                                 std::optional<Rights> rights, Authenticate authenticate);

}  // namespace wayfuse
