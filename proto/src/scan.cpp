#include "wayfuse/proto/scan.hpp"

namespace wayfuse {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

std::string to_string(Bssid bssid) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(17);
  for (int octet = 5; octet >= 0; --octet) {
    const auto byte = static_cast<unsigned>(bssid.value >> (8 * octet)) & 0xffu;
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15u];
    if (octet > 0) text += ':';
  }
  return text;
}

std::optional<Bssid> parse_bssid(std::string_view text) {
  if (text.size() != 17 && text.size() != 12) return std::nullopt;
  const bool separated = text.size() == 17;
  const char separator = separated ? text[2] : '\0';
  if (separated && separator != ':' && separator != '-') return std::nullopt;
  Bssid bssid;
  for (std::size_t octet = 0; octet < 6; ++octet) {
    const std::size_t at = octet * (separated ? 3 : 2);
    if (separated && octet > 0 && text[at - 1] != separator) return std::nullopt;
    const int high = hex_digit(text[at]);
    const int low = hex_digit(text[at + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    bssid.value = bssid.value << 8 | static_cast<std::uint64_t>(high * 16 + low);
  }
  return bssid;
}

}  // namespace wayfuse
