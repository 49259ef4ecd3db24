#include "proto/src/wire/kinds.hpp"

#include <algorithm>

#include "proto/src/wire/text.hpp"

namespace wayfuse::wire {
namespace {

bool is_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
}

}  // namespace

Refusal outside(double wire, double least, double most) {
  const std::string range = shown(least) + ".." + shown(most);
  if (!std::isfinite(wire)) return {FaultCode::kOutOfRange, shown(wire) + " is not finite; " + range + " is expected"};
  return {FaultCode::kOutOfRange, shown(wire) + " is outside " + range};
}

Refusal outside(std::int64_t wire, const Integer& kind) {
  return {FaultCode::kOutOfRange,
          std::to_string(wire) + " is outside " + std::to_string(kind.least) + ".." + std::to_string(kind.most)};
}

Refusal wrong_count(std::size_t count, std::size_t least, std::size_t most) {
  if (count > most) return {FaultCode::kTooLarge, std::to_string(count) + " elements, at most " + std::to_string(most)};
  return {FaultCode::kOutOfRange, std::to_string(count) + " elements, at least " + std::to_string(least)};
}

std::optional<Refusal> refuse(std::string_view text, const Text& kind) {
  if (text.size() > kind.most) {
    return Refusal{FaultCode::kTooLarge, std::to_string(text.size()) + " bytes, at most " + std::to_string(kind.most)};
  }
  if (!is_utf8(text)) return Refusal{FaultCode::kBadText, quoted(text) + " is not UTF-8"};
  if (has_controls(text)) return Refusal{FaultCode::kBadText, quoted(text) + " holds a control character"};
  if (text.size() < kind.least) return Refusal{FaultCode::kOutOfRange, "is empty"};
  if (kind.key && !std::ranges::all_of(text, is_key_character)) {
    return Refusal{FaultCode::kBadText, quoted(text) + " holds other characters than A-Z a-z 0-9 . _ -"};
  }
  return std::nullopt;
}

std::optional<Refusal> refuse_bytes(std::string_view bytes, const Bytes& kind) {
  if (bytes.size() <= kind.most) return std::nullopt;
  return Refusal{FaultCode::kTooLarge, std::to_string(bytes.size()) + " bytes, at most " + std::to_string(kind.most)};
}

}  // namespace wayfuse::wire
