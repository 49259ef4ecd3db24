#include "admin/session_token.hpp"

#include <sodium.h>

#include <array>
#include <cstring>

namespace wayfuse {
namespace {

constexpr std::string_view kPrefix = "ws_";
constexpr std::string_view kPurpose = "wayfuse session token 1";  // keys and tokens never share a digest
constexpr std::size_t kFields = 3 * sizeof(std::uint64_t);
constexpr std::size_t kDigest = crypto_generichash_BYTES;
constexpr int kAlphabet = sodium_base64_VARIANT_URLSAFE_NO_PADDING;

using Bytes = std::array<unsigned char, kFields + kDigest>;

void put(unsigned char* at, std::uint64_t value) {
  for (std::size_t i = 0; i < sizeof value; ++i) at[i] = static_cast<unsigned char>(value >> (8 * i));
}

std::uint64_t get(const unsigned char* at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof value; ++i) value |= std::uint64_t{at[i]} << (8 * i);
  return value;
}

std::array<unsigned char, kDigest> digest_of(const unsigned char* fields, std::string_view secret) {
  std::array<unsigned char, kPurpose.size() + kFields> message;
  std::memcpy(message.data(), kPurpose.data(), kPurpose.size());
  std::memcpy(message.data() + kPurpose.size(), fields, kFields);
  std::array<unsigned char, kDigest> digest;
  crypto_generichash(digest.data(), digest.size(), message.data(), message.size(),
                     reinterpret_cast<const unsigned char*>(secret.data()), secret.size());
  return digest;
}

}  // namespace

std::string seal(const SessionToken& token, std::string_view secret) {
  Bytes bytes;
  put(bytes.data(), token.key_id);
  put(bytes.data() + 8, token.building.value);
  put(bytes.data() + 16, static_cast<std::uint64_t>(token.expires_at.time_since_epoch().count()));
  const auto digest = digest_of(bytes.data(), secret);
  std::memcpy(bytes.data() + kFields, digest.data(), digest.size());
  std::string text(sodium_base64_encoded_len(bytes.size(), kAlphabet), '\0');
  sodium_bin2base64(text.data(), text.size(), bytes.data(), bytes.size(), kAlphabet);
  text.pop_back();  // its final zero
  return std::string(kPrefix) + text;
}

bool looks_like_session_token(std::string_view text) { return text.starts_with(kPrefix); }

std::optional<SessionToken> unseal(std::string_view text, std::string_view secret) {
  if (!looks_like_session_token(text)) return std::nullopt;
  text.remove_prefix(kPrefix.size());
  Bytes bytes;
  std::size_t length = 0;
  if (sodium_base642bin(bytes.data(), bytes.size(), text.data(), text.size(), nullptr, &length, nullptr, kAlphabet) != 0 ||
      length != bytes.size()) {
    return std::nullopt;
  }
  const auto digest = digest_of(bytes.data(), secret);
  if (sodium_memcmp(digest.data(), bytes.data() + kFields, digest.size()) != 0) return std::nullopt;
  return SessionToken{get(bytes.data()),
                      {get(bytes.data() + 8)},
                      UnixTime{Duration{static_cast<std::int64_t>(get(bytes.data() + 16))}}};
}

}  // namespace wayfuse
