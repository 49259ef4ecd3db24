#pragma once

#include <deque>
#include <optional>
#include <string>

#include "wayfuse/proto/codec.hpp"

namespace wayfuse {

/// What waits to be written to one client: bounded, and never a backlog of what is outdated [SAFETY C12].
///
/// A newer ack replaces the older (they are cumulative), a newer position or no_fix replaces the older; everything else
/// keeps its order and goes out first. Thread: the connection's strand.
class Outbox {
 public:
  struct Bounds {
    std::size_t messages = 64;
    std::size_t bytes = 256 * 1024;
  };
  Outbox(Encoding encoding, Bounds bounds) : encoding_(encoding), bounds_(bounds) {}

  /// False = the bound is reached and the message was not taken: the client is too slow to be kept.
  bool push(const ServerMessage& message);
  /// The next frame to write.
  std::optional<std::string> pop();

  bool empty() const { return frames_.empty() && !ack_ && !position_; }
  std::size_t bytes() const { return bytes_; }
  void clear();

 private:
  const Encoding encoding_;
  const Bounds bounds_;
  std::deque<std::string> frames_;
  std::size_t bytes_ = 0;
  std::optional<Ack> ack_;
  std::optional<ServerMessage> position_;  ///< Position or NoFix
};

}  // namespace wayfuse
