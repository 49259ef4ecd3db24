#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <string_view>

#include "admin/router.hpp"
#include "server/net/address_book.hpp"
#include "server/net/deadline_wheel.hpp"
#include "server/net/outbox.hpp"
#include "server/sessions/session.hpp"
#include "server/sessions/session_world.hpp"

namespace wayfuse {

struct NetSettings {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;              ///< 0 = any free one
  std::string tls_certificate;         ///< PEM chain; empty = plain
  std::string tls_key;                 ///< PEM
  bool plain_beyond_loopback = false;  ///< plain HTTP on other addresses, where a proxy speaks TLS [C3]
  std::size_t connections_most = 16000;
  std::size_t half_open_most = 2000;                       ///< without a complete first request [C6]
  Duration handshake_deadline = std::chrono::seconds(10);  ///< TLS and the first request's header [C6]
  Duration body_deadline = std::chrono::seconds(60);
  Duration keep_alive_deadline = std::chrono::seconds(30);  ///< between HTTP requests
  Duration http_write_deadline = std::chrono::seconds(60);
  Duration ping_interval = std::chrono::seconds(20);  ///< [C11]
  Duration dead_after = std::chrono::seconds(60);
  Duration write_deadline = std::chrono::seconds(5);  ///< one WebSocket message [C12]
  Duration close_deadline = std::chrono::seconds(2);
  std::uint32_t header_bytes = 16 * 1024;  ///< [C4]
  std::size_t header_fields = 100;
  std::uint64_t body_bytes = 1024 * 1024;
  std::uint64_t upload_bytes = 8 * 1024 * 1024;  ///< bodies of POST and PUT
  double frames_per_second = 100;                ///< of one session; beyond it reading pauses [C5]
  double frames_burst = 1000;
  std::uint64_t memory_budget_bytes = 1536ull * 1024 * 1024;  ///< counted by MemoryBudget
  Outbox::Bounds outbox;
  AddressBook::Settings addresses;
};

/// What happened on the network, for the metrics.
struct NetCounters {
  using Count = std::atomic<std::uint64_t>;
  Count accepted{0};
  Count refused{0};          ///< caps and rates, before the first byte was read
  Count accept_failures{0};  ///< out of descriptors and the like
  Count connections{0};      ///< open now
  Count half_open{0};        ///< open now without a complete request
  Count websockets{0};       ///< open now
  Count tls_failures{0};
  Count handshake_timeouts{0};
  Count authentication_failures{0};
  Count http_ok{0};  ///< 1xx to 3xx
  Count http_client_errors{0};
  Count http_server_errors{0};
  Count frames_in{0};
  Count frames_out{0};
  Count bytes_in{0};
  Count bytes_out{0};
  Count slow_closed{0};   ///< outbox full or write blocked
  Count dead_closed{0};   ///< no sign of life
  Count read_pauses{0};   ///< a session sent faster than it may
  Count outbox_bytes{0};  ///< waiting now, all sessions
  Count shed{0};          ///< sessions refused or observers closed for want of memory
};

/// Counts what connections and sessions hold, by measured sizes, and says when it is too much [SAFETY C12].
class MemoryBudget {
 public:
  MemoryBudget(const NetCounters& net, const SessionShelf& sessions, std::uint64_t limit_bytes, bool tls)
      : net_(net),
        sessions_(sessions),
        limit_bytes_(limit_bytes),
        connection_bytes_(tls ? kTlsConnectionBytes : kConnectionBytes) {}
  double used() const {
    const std::uint64_t bytes = net_.connections * connection_bytes_ + sessions_.size() * kSessionBytes + net_.outbox_bytes;
    return static_cast<double>(bytes) / static_cast<double>(limit_bytes_);
  }
  bool takes_sessions() const { return used() < 0.80; }
  bool keeps_observers() const { return used() < 0.95; }

 private:
  static constexpr std::uint64_t kConnectionBytes = 12 * 1024;
  static constexpr std::uint64_t kTlsConnectionBytes = 80 * 1024;
  static constexpr std::uint64_t kSessionBytes = 200 * 1024;
  const NetCounters& net_;
  const SessionShelf& sessions_;
  const std::uint64_t limit_bytes_;
  const std::uint64_t connection_bytes_;
};

/// All that connections need from outside. Thread: what it refers to is safe from any strand.
struct NetWorld {
  NetWorld(SessionWorld& session_world, const Router& admin_router, const Access& admin_access, const Clock& net_clock,
           NetCounters& net_counters, NetSettings net_settings, std::function<void(std::string_view)> net_complain)
      : sessions(session_world),
        router(admin_router),
        access(admin_access),
        clock(net_clock),
        counters(net_counters),
        settings(std::move(net_settings)),
        complain(std::move(net_complain)) {}

  SessionWorld& sessions;
  const Router& router;
  const Access& access;
  const Clock& clock;
  NetCounters& counters;
  NetSettings settings;
  std::function<void(std::string_view)> complain;  ///< for the log; never with addresses, tokens or positions
  DeadlineWheel wheel;
  std::shared_ptr<AddressBook> addresses = std::make_shared<AddressBook>(settings.addresses);
  MemoryBudget budget{counters, sessions.sessions, settings.memory_budget_bytes, !settings.tls_certificate.empty()};
  std::atomic<bool> draining{false};
};

/// What a principal may do in a session.
Rights rights_of(const Principal& principal);

}  // namespace wayfuse
