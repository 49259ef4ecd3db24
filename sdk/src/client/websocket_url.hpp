#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// A WebSocket address taken apart.
struct WebsocketUrl {
  bool tls = true;
  std::string host;          ///< without brackets
  std::string port;          ///< decimal
  std::string path = "/";    ///< with query
  std::string host_header;   ///< as the Host header wants it
};

/// Fault kOutOfRange on field `url`. User names and fragments are refused.
Result<WebsocketUrl> parse_websocket_url(std::string_view url);

}  // namespace wayfuse
