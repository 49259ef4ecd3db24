#pragma once

#include <optional>

#include "server/net/http_messages.hpp"
#include "server/net/net_world.hpp"
#include "server/net/streams.hpp"

namespace wayfuse {

/// The path sessions are opened on.
inline constexpr std::string_view kSessionPath = "/v1/session";

/// The best subprotocol of those the client offers in Sec-WebSocket-Protocol.
std::optional<Encoding> negotiate(std::string_view offered);

/// Takes a stream over whose upgrade request was read and found good. It lives until the conversation or the network ends.
/// `rights` are absent where the request named no key: then the hello must.
void serve_websocket(NetWorld& world, PlainStream stream, HttpRequest upgrade, Encoding encoding, std::optional<Rights> rights,
                     Visit visit);
void serve_websocket(NetWorld& world, TlsStream stream, HttpRequest upgrade, Encoding encoding, std::optional<Rights> rights,
                     Visit visit);

}  // namespace wayfuse
