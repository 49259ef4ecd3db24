#include "sdk/src/client/websocket_url.hpp"

#include <algorithm>

namespace wayfuse {
namespace {

Fault refuse(std::string cause) { return {FaultCode::kOutOfRange, "url", std::move(cause)}; }

bool visible(char c) { return c > ' ' && c < '\x7f'; }

bool valid_port(std::string_view port) {
  if (port.empty() || port.size() > 5 || !std::all_of(port.begin(), port.end(), [](char c) { return c >= '0' && c <= '9'; })) {
    return false;
  }
  const int number = std::stoi(std::string(port));
  return number >= 1 && number <= 65535;
}

}  // namespace

Result<WebsocketUrl> parse_websocket_url(std::string_view url) {
  WebsocketUrl parsed;
  if (url.size() > 2048) return refuse("longer than 2048 bytes");
  if (!std::all_of(url.begin(), url.end(), visible)) return refuse("holds spaces, control or non-ASCII characters");
  if (url.starts_with("wss://")) {
    url.remove_prefix(6);
  } else if (url.starts_with("ws://")) {
    url.remove_prefix(5);
    parsed.tls = false;
  } else {
    return refuse("must begin with wss:// or ws://");
  }
  const std::size_t end = std::min(url.find_first_of("/?#"), url.size());
  std::string_view authority = url.substr(0, end);
  const std::string_view rest = url.substr(end);
  if (rest.find('#') != std::string_view::npos) return refuse("a fragment has no meaning here");
  if (authority.find('@') != std::string_view::npos) return refuse("a user name does not belong into the address");
  if (!rest.empty()) parsed.path = rest.front() == '/' ? std::string(rest) : "/" + std::string(rest);
  parsed.host_header = std::string(authority);
  std::string_view port = parsed.tls ? "443" : "80";
  if (authority.starts_with('[')) {  // [IPv6]
    const std::size_t bracket = authority.find(']');
    if (bracket == std::string_view::npos) return refuse("a bracket is not closed");
    parsed.host = std::string(authority.substr(1, bracket - 1));
    authority.remove_prefix(bracket + 1);
    if (!authority.empty() && authority.front() != ':') return refuse("after ] only a port may come");
    if (!authority.empty()) port = authority.substr(1);
  } else {
    const std::size_t colon = authority.find(':');
    parsed.host = std::string(authority.substr(0, colon));
    if (colon != std::string_view::npos) port = authority.substr(colon + 1);
  }
  if (parsed.host.empty()) return refuse("names no host");
  if (!valid_port(port)) return refuse("the port is not 1..65535");
  parsed.port = std::string(port);
  return parsed;
}

}  // namespace wayfuse
