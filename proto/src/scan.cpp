#include "wayfuse/proto/scan.hpp"

#include <algorithm>
#include <array>

namespace wayfuse {
namespace {

// 16 and more for what is no hexadecimal digit.
constexpr std::array<std::uint8_t, 256> hex_digits() {
  std::array<std::uint8_t, 256> digits{};
  digits.fill(16);
  for (std::uint8_t i = 0; i < 10; ++i) digits['0' + i] = i;
  for (std::uint8_t i = 0; i < 6; ++i) digits['a' + i] = digits['A' + i] = static_cast<std::uint8_t>(10 + i);
  return digits;
}
constexpr std::array<std::uint8_t, 256> kHexDigits = hex_digits();

unsigned hex_digit(char c) { return kHexDigits[static_cast<unsigned char>(c)]; }

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
    const unsigned high = hex_digit(text[at]);
    const unsigned low = hex_digit(text[at + 1]);
    if ((high | low) >= 16) return std::nullopt;
    bssid.value = bssid.value << 8 | (high * 16 + low);
  }
  return bssid;
}

std::size_t keep_youngest(RssScan& scan, std::size_t most) {
  if (scan.readings.size() <= most) return 0;
  const std::size_t left_out = scan.readings.size() - most;
  std::stable_sort(scan.readings.begin(), scan.readings.end(), [](const ScanReading& a, const ScanReading& b) { return a.age < b.age; });
  scan.readings.resize(most);
  return left_out;
}

}  // namespace wayfuse
