#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// Where a session's answers go. The implementation bounds and conflates: positions are replaced by newer ones, acks and
/// faults are never dropped [SAFETY C12].
class SessionOutput {
 public:
  virtual ~SessionOutput() = default;
  virtual void send(const ServerMessage& message) = 0;
  /// Says the fault (where the table gives a close code) and closes.
  virtual void close(const Fault& reason) = 0;
};

/// Protocol without sockets: one connection's conversation after authentication.
///
/// Thread: confined to the connection's strand; answers from the store are posted back to it.
class Conversation {
 public:
  virtual ~Conversation() = default;
  virtual void receive(ClientMessage message) = 0;
  /// A frame that did not decode.
  virtual void receive(const Fault& malformed) = 0;
  /// Called about once a second: idle deadlines, resolve time-outs, conflated observations.
  virtual void tick() = 0;
  /// The connection is gone; a tracking session stays resumable.
  virtual void disconnected() = 0;
};

}  // namespace wayfuse
