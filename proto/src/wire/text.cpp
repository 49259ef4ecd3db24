#include "proto/src/wire/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace wayfuse::wire {
namespace {

constexpr std::string_view kBase64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t kNoDigit = 64;

constexpr std::array<std::uint8_t, 256> base64_digits() {
  std::array<std::uint8_t, 256> digits{};
  digits.fill(kNoDigit);
  for (std::size_t i = 0; i < kBase64.size(); ++i)
    digits[static_cast<unsigned char>(kBase64[i])] = static_cast<std::uint8_t>(i);
  return digits;
}
constexpr std::array<std::uint8_t, 256> kBase64Digits = base64_digits();

unsigned byte_at(std::string_view text, std::size_t i) {
  return static_cast<unsigned char>(text[i]);
}

// Length of the well-formed character at `i`, 0 if there is none.
std::size_t character_length(std::string_view text, std::size_t i) {
  const unsigned lead = byte_at(text, i);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || i + length > text.size()) return 0;
  const unsigned second = byte_at(text, i + 1);
  const unsigned least = lead == 0xe0 ? 0xa0 : lead == 0xf0 ? 0x90 : 0x80;
  const unsigned most = lead == 0xed ? 0x9f : lead == 0xf4 ? 0x8f : 0xbf;
  if (second < least || second > most) return 0;
  for (std::size_t k = 2; k < length; ++k) {
    if ((byte_at(text, i + k) & 0xc0u) != 0x80u) return 0;
  }
  return length;
}

bool is_control(std::string_view text, std::size_t i) {
  const unsigned lead = byte_at(text, i);
  if (lead < 0x20 || lead == 0x7f) return true;
  return lead == 0xc2 && i + 1 < text.size() && byte_at(text, i + 1) < 0xa0;
}

}  // namespace

bool is_utf8(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size()) {
    if (i + 8 <= text.size()) {
      std::uint64_t eight;
      std::memcpy(&eight, text.data() + i, 8);
      if ((eight & 0x8080808080808080u) == 0) {
        i += 8;
        continue;
      }
    }
    if (byte_at(text, i) < 0x80) {
      ++i;
      continue;
    }
    const std::size_t length = character_length(text, i);
    if (length == 0) return false;
    i += length;
  }
  return true;
}

bool has_controls(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (is_control(text, i)) return true;
  }
  return false;
}

std::string clipped(std::string_view text, std::size_t bytes) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = character_length(text, i);
    const bool shown_as_is = length > 0 && !is_control(text, i);
    if (out.size() + (shown_as_is ? length : 1) > bytes) break;
    if (shown_as_is) {
      out += text.substr(i, length);
    } else {
      out += '?';
    }
    i += std::max<std::size_t>(length, 1);
  }
  return out;
}

std::string quoted(std::string_view text) {
  const std::string shown_text = clipped(text, 64);
  return '\'' + shown_text + (shown_text.size() < text.size() ? "...'" : "'");
}

std::string to_base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    const unsigned bits =
        byte_at(bytes, i) << 16 | (left > 1 ? byte_at(bytes, i + 1) << 8 : 0u) | (left > 2 ? byte_at(bytes, i + 2) : 0u);
    text += kBase64[bits >> 18];
    text += kBase64[bits >> 12 & 63u];
    text += left > 1 ? kBase64[bits >> 6 & 63u] : '=';
    text += left > 2 ? kBase64[bits & 63u] : '=';
  }
  return text;
}

std::optional<std::string> from_base64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (std::size_t i = 0; i < text.size(); i += 4) {
    const bool last = i + 4 == text.size();
    const std::size_t padding = last && text[i + 3] == '=' ? (text[i + 2] == '=' ? 2 : 1) : 0;
    unsigned bits = 0;
    for (std::size_t k = 0; k < 4 - padding; ++k) {
      const unsigned digit = kBase64Digits[static_cast<unsigned char>(text[i + k])];
      if (digit == kNoDigit) return std::nullopt;
      bits = bits << 6 | digit;
    }
    if (padding > 0 && (bits & (padding == 1 ? 3u : 15u)) != 0) return std::nullopt;
    bits <<= 6 * padding;
    bytes += static_cast<char>(bits >> 16);
    if (padding < 2) bytes += static_cast<char>(bits >> 8 & 0xffu);
    if (padding < 1) bytes += static_cast<char>(bits & 0xffu);
  }
  return bytes;
}

void append_number(std::string& out, double value) {
  std::array<char, 32> digits;
  if (value == 0.0) value = 0.0;  // no "-0"
  const bool whole = value == std::floor(value) && std::fabs(value) <= 9007199254740992.0;
  const auto end = whole ? std::to_chars(digits.data(), digits.data() + digits.size(), static_cast<std::int64_t>(value)).ptr
                         : std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  out.append(digits.data(), end);
}

std::string shown(double value) {
  if (std::isnan(value)) return "not a number";
  if (std::isinf(value)) return value < 0 ? "-infinity" : "infinity";
  std::string text;
  append_number(text, value);
  return text;
}

}  // namespace wayfuse::wire
