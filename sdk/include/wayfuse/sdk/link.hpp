#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "wayfuse/proto/codec.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Where the client's frames go: the seam between the protocol and the network. One link is one connection attempt.
///
/// Thread: calls and callbacks all happen on the link's own thread of control (the io thread for WebsocketLink, the
/// simulation's loop in tests).
class Link {
 public:
  struct Events {
    std::function<void(Encoding)> opened;
    std::function<void(std::string_view frame)> received;
    /// Last event of a link, also after a failed open. `reason` is for people.
    std::function<void(std::string_view reason)> closed;
    /// The peer lives, though it sent no frame (a ping or a pong). A link without such signs never calls it.
    std::function<void()> alive;
  };
  virtual ~Link() = default;
  /// Starts connecting; the events tell how it went.
  virtual void open(Events events) = 0;
  /// Queues one frame. False = the link's bound is reached: keep the frame and try after `received` or later.
  virtual bool send(std::string frame) = 0;
  /// Sends what is queued, then closes; within 2 s in any case. `closed` may or may not come after this.
  virtual void close() = 0;
};

/// Timers and time of the client's own world: real ones for WebsocketLink, virtual ones in a simulation.
class Scheduler {
 public:
  virtual ~Scheduler() = default;
  virtual PhoneTime now() const = 0;
  /// Calls `task` once after `delay`; returns a number for cancel().
  virtual std::uint64_t after(Duration delay, std::function<void()> task) = 0;
  virtual void cancel(std::uint64_t timer) = 0;
};

}  // namespace wayfuse
