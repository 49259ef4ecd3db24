#pragma once

#include <string>

#include "wayfuse/proto/result.hpp"

struct sockaddr;

namespace wayfuse {

/// Whether an address belongs to the public internet: not loopback, link-local, private, shared (RFC 6598), multicast,
/// unspecified, reserved or documentation space, nor an IPv4 address of these in IPv6 clothes. A webhook must not be a way into the
/// network the server stands in.
bool is_public(const sockaddr& address);
/// The same of an address in text; false for what is none.
bool is_public_address(const std::string& text);

/// `https://host[:port]/path`, at most 2,048 bytes, without a user; plain HTTP only where private targets are allowed. A host
/// that is an address is looked at here, a name when it is connected to.
Result<void> check_webhook_url(const std::string& url, bool private_targets);

}  // namespace wayfuse
