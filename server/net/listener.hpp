#pragma once

#include <functional>
#include <memory>

#include "server/net/net_world.hpp"

namespace wayfuse {

/// The network's front door and its threads: accepts, hands over, drains. The header is free of Asio.
///
/// Thread: start() to stop() belong to the owner; the rest any.
class Listener {
 public:
  /// Binds and listens. Faults: a port in use, a certificate that cannot be read, plain HTTP where it is not allowed.
  static Result<std::unique_ptr<Listener>> open(NetWorld& world);
  ~Listener();

  std::uint16_t port() const;
  /// Accepts from here on, on `threads` threads of its own.
  void start(unsigned threads);
  /// Runs `task` every `interval` on one of those threads.
  void every(Duration interval, std::function<void()> task);
  /// Reads certificate and key again; connections that stand keep theirs.
  Result<void> reload_tls();
  /// Stops accepting and sends everybody away, spread over `within` [SAFETY C20]; returns once all are gone or `at_most`
  /// has passed, and cuts those that are left.
  void drain(Duration within, Duration at_most);
  /// Joins the threads. Nothing runs on them afterwards.
  void stop();

 private:
  struct State;
  explicit Listener(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace wayfuse
