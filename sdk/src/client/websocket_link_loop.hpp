#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <memory>

#include "sdk/src/client/websocket_url.hpp"
#include "wayfuse/sdk/websocket_link.hpp"

namespace wayfuse {

struct NetworkLoop::State : std::enable_shared_from_this<NetworkLoop::State> {
  boost::asio::io_context io{1};
  std::uint64_t last_timer = 0;
  std::map<std::uint64_t, std::shared_ptr<boost::asio::steady_timer>> timers;
};

/// What all links to one server share.
struct WebsocketTarget {
  WebsocketLinkSettings settings;
  WebsocketUrl url;
  boost::asio::io_context& io;
  std::shared_ptr<boost::asio::ssl::context> tls;  // absent for ws://
};

/// A TLS context that verifies: system store or the given certificates, TLS 1.2 and up. Fault on field `ca_file` or `ca_pem`.
Result<std::shared_ptr<boost::asio::ssl::context>> make_tls_context(const WebsocketLinkSettings& settings);
/// Base64 of SHA-256 over a certificate's SubjectPublicKeyInfo [RFC 7469].
std::string public_key_pin(X509* certificate);

std::unique_ptr<Link> make_websocket_link(std::shared_ptr<const WebsocketTarget> target);

}  // namespace wayfuse
