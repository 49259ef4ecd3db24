#pragma once

#include "server/net/net_world.hpp"
#include "server/net/streams.hpp"

namespace wayfuse {

/// Serves HTTP on a fresh connection until it ends or becomes a WebSocket. With `visit.tls` the TLS handshake comes first.
void serve_http(NetWorld& world, PlainStream socket, Visit visit);

}  // namespace wayfuse
