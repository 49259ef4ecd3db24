#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "wayfuse/proto/result.hpp"
#include "wayfuse/sdk/client.hpp"
#include "wayfuse/sdk/link.hpp"

namespace wayfuse {

/// How to reach a server. TLS certificates are always verified; there is no switch for that.
struct WebsocketLinkSettings {
  std::string url;                  ///< wss://host[:port]/path, or ws:// (loopback only, unless `allow_plain`)
  bool allow_plain = false;         ///< ws:// to other machines too: positions and tokens go in the clear
  std::string ca_file;              ///< PEM; empty = the system's store, unless `ca_pem`
  std::string ca_pem;               ///< trusted certificates as text; replaces the system's store
  /// Base64 of SHA-256 over the server's SubjectPublicKeyInfo, as in RFC 7469. With any given, one must match as well.
  std::vector<std::string> pins;
  std::function<std::string()> authorization;  ///< value of the Authorization header, asked at every connection; empty = none
  bool offer_cbor = true;
  bool offer_json = true;
  Duration handshake_most = std::chrono::seconds(20);  ///< name look-up to upgrade
  Duration idle_most = std::chrono::seconds(90);       ///< without a byte: dead
  Duration write_most = std::chrono::seconds(10);      ///< of one frame
  Duration close_most = std::chrono::seconds(2);       ///< of the farewell
  std::size_t queued_frames_most = 64;
  std::size_t queued_bytes_most = 256 * 1024;
};

/// The real world for a Client: sockets and timers on one thread of control.
///
/// Thread: everything of a client (its calls, its events) happens inside run() or poll(); post() and stop() may come from any
/// thread. The clock is the system's monotonic one that counts through sleep where there is one (CLOCK_BOOTTIME, as Android
/// stamps sensors with).
class NetworkLoop final : public Scheduler {
 public:
  NetworkLoop();
  /// Ends every link at once. No run() may be under way.
  ~NetworkLoop() override;
  NetworkLoop(const NetworkLoop&) = delete;
  NetworkLoop& operator=(const NetworkLoop&) = delete;

  PhoneTime now() const override { return clock_now(); }
  /// The same clock without a loop; any thread.
  static PhoneTime clock_now();
  std::uint64_t after(Duration delay, std::function<void()> task) override;
  void cancel(std::uint64_t timer) override;

  /// Has the loop call `task` soon.
  void post(std::function<void()> task);
  /// Works until stop().
  void run();
  /// Works for `span`, or until stop().
  void run_for(Duration span);
  /// Makes run() return; the next run() goes on.
  void stop();

  /// Links to one server, for Client. A fault names what is wrong with the settings. The loop must outlive the links.
  Result<Client::LinkFactory> links(WebsocketLinkSettings settings);

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace wayfuse
