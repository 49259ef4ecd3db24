#include "server/webhooks/target_guard.hpp"

#include <arpa/inet.h>
#include <curl/curl.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

namespace wayfuse {
namespace {

constexpr std::size_t kLongestUrl = 2048;

struct Block4 {
  std::uint32_t first;
  int bits;
};
// IANA's special-purpose registry, and multicast.
constexpr std::array<Block4, 14> kNotPublic4 = {{{0x00000000, 8},     // this network
                                                 {0x0a000000, 8},     // private
                                                 {0x64400000, 10},    // shared
                                                 {0x7f000000, 8},     // loopback
                                                 {0xa9fe0000, 16},    // link-local
                                                 {0xac100000, 12},    // private
                                                 {0xc0000000, 24},    // protocol assignments
                                                 {0xc0000200, 24},    // documentation
                                                 {0xc0a80000, 16},    // private
                                                 {0xc6120000, 15},    // benchmarking
                                                 {0xc6336400, 24},    // documentation
                                                 {0xcb007100, 24},    // documentation
                                                 {0xe0000000, 4},     // multicast
                                                 {0xf0000000, 4}}};   // reserved, broadcast

bool is_public4(std::uint32_t address) {
  return std::ranges::none_of(kNotPublic4, [&](const Block4& block) { return (address ^ block.first) >> (32 - block.bits) == 0; });
}

bool is_public6(const in6_addr& address) {
  const unsigned char* b = address.s6_addr;
  const auto ipv4_at = [&](int at) {
    return std::uint32_t{b[at]} << 24 | std::uint32_t{b[at + 1]} << 16 | std::uint32_t{b[at + 2]} << 8 | std::uint32_t{b[at + 3]};
  };
  if (IN6_IS_ADDR_V4MAPPED(&address) || IN6_IS_ADDR_V4COMPAT(&address)) return is_public4(ipv4_at(12));
  if (b[0] == 0x00 && b[1] == 0x64 && b[2] == 0xff && b[3] == 0x9b) return is_public4(ipv4_at(12));  // NAT64
  if (b[0] == 0x20 && b[1] == 0x02) return is_public4(ipv4_at(2));                                  // 6to4
  if (b[0] == 0x20 && b[1] == 0x01 && b[2] == 0x0d && b[3] == 0xb8) return false;                   // documentation
  if (b[0] == 0x20 && b[1] == 0x01 && b[2] < 0x02) return false;                                    // Teredo and its like
  return (b[0] & 0xe0) == 0x20;                                                                     // global unicast, 2000::/3
}

std::string part_of(CURLU* url, CURLUPart part) {
  char* text = nullptr;
  if (curl_url_get(url, part, &text, 0) != CURLUE_OK) return {};
  std::string found = text;
  curl_free(text);
  return found;
}

}  // namespace

bool is_public(const sockaddr& address) {
  if (address.sa_family == AF_INET) {
    sockaddr_in v4;
    std::memcpy(&v4, &address, sizeof v4);
    return is_public4(ntohl(v4.sin_addr.s_addr));
  }
  if (address.sa_family == AF_INET6) {
    sockaddr_in6 v6;
    std::memcpy(&v6, &address, sizeof v6);
    return is_public6(v6.sin6_addr);
  }
  return false;
}

bool is_public_address(const std::string& text) {
  in_addr v4;
  if (::inet_pton(AF_INET, text.c_str(), &v4) == 1) return is_public4(ntohl(v4.s_addr));
  in6_addr v6;
  return ::inet_pton(AF_INET6, text.c_str(), &v6) == 1 && is_public6(v6);
}

Result<void> check_webhook_url(const std::string& url, bool private_targets) {
  const auto refuse = [](FaultCode code, std::string cause) { return Fault{code, "url", std::move(cause)}; };
  if (url.size() > kLongestUrl) return refuse(FaultCode::kTooLarge, "is longer than 2048 bytes");
  const std::unique_ptr<CURLU, decltype(&curl_url_cleanup)> parsed(curl_url(), curl_url_cleanup);
  if (curl_url_set(parsed.get(), CURLUPART_URL, url.c_str(), CURLU_NON_SUPPORT_SCHEME) != CURLUE_OK) {
    return refuse(FaultCode::kOutOfRange, "is no URL");
  }
  const std::string scheme = part_of(parsed.get(), CURLUPART_SCHEME);
  if (scheme != "https" && !(scheme == "http" && private_targets)) {
    return refuse(FaultCode::kOutOfRange, scheme == "http" ? "must be https; plain http needs webhooks.private_targets" : "must be https");
  }
  if (!part_of(parsed.get(), CURLUPART_USER).empty() || !part_of(parsed.get(), CURLUPART_PASSWORD).empty()) {
    return refuse(FaultCode::kOutOfRange, "must not hold a user or a password");
  }
  std::string host = part_of(parsed.get(), CURLUPART_HOST);
  if (host.size() > 2 && host.front() == '[') host = host.substr(1, host.size() - 2);
  in6_addr any;
  const bool literal = ::inet_pton(AF_INET, host.c_str(), &any) == 1 || ::inet_pton(AF_INET6, host.c_str(), &any) == 1;
  if (!private_targets && (host == "localhost" || (literal && !is_public_address(host)))) {
    return refuse(FaultCode::kNotAllowed, "leads into a private network; that needs webhooks.private_targets");
  }
  return {};
}

}  // namespace wayfuse
