#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/simulation/simulated_server.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/sdk/link.hpp"

namespace wayfuse {

/// What the network does to connections. Probabilities are per connection or per frame.
struct NetworkWeather {
  double connect_fails = 0.0;
  double slow_frame = 0.0;  ///< takes up to `slow_most`
  Duration delay_most = std::chrono::milliseconds(80);
  Duration slow_most = std::chrono::seconds(4);
  Duration life_mean = std::chrono::hours(1);         ///< of a connection, exponentially distributed
  Duration unnoticed_most = std::chrono::seconds(5);  ///< until the server learns that a phone is gone
};

/// Hears every frame that arrives, in the order of arrival.
class FrameWitness {
 public:
  virtual ~FrameWitness() = default;
  virtual void server_heard(std::uint64_t connection, const ClientMessage& message) = 0;
  virtual void server_said(std::uint64_t connection, const ServerMessage& message) = 0;
  virtual void frame_arrived(PhoneTime at, std::string_view frame) = 0;
};

/// Streams between clients and one server, in virtual time: frames keep their order, take time, and are lost with their
/// connection; the two ends learn of its end at different times. Everything random comes from the seed.
class SimulatedNetwork {
 public:
  SimulatedNetwork(VirtualScheduler& scheduler, std::uint64_t seed, FrameWitness& witness);
  ~SimulatedNetwork();

  NetworkWeather weather;
  /// Null = nobody listens: connections fail.
  void attach(SimulatedServer* server);
  /// Every connection breaks at once, as when the server's process dies.
  void break_all();
  std::unique_ptr<Link> make_link();
  /// Once a second: the conversations' deadlines.
  void tick();

 private:
  friend class SimulatedLink;
  class Connection;
  std::shared_ptr<Connection> connect(Link::Events events);
  Duration delay();

  VirtualScheduler& scheduler_;
  Random random_;
  FrameWitness& witness_;
  SimulatedServer* server_ = nullptr;
  std::vector<std::shared_ptr<Connection>> connections_;
  std::uint64_t last_connection_ = 0;
};

}  // namespace wayfuse
