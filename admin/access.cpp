#include "admin/access.hpp"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "admin/session_token.hpp"

namespace wayfuse {
namespace {

constexpr std::array kScopeNames = {
    std::pair{Scope::kTrack, std::string_view("track")}, std::pair{Scope::kSurvey, std::string_view("survey")},
    std::pair{Scope::kObserve, std::string_view("observe")}, std::pair{Scope::kAdmin, std::string_view("admin")}};
constexpr std::string_view kKeyPrefix = "wf_";
constexpr std::size_t kKeyBytes = 32;
constexpr std::size_t kHashBytes = crypto_generichash_BYTES;

Principal principal_from(const KeyRecord& record) {
  Principal principal{record.id, record.name, {}, record.building, record.expires_at, record.coarse};
  for (const std::string& name : record.scopes) {
    if (const auto scope = scope_of(name)) principal.scopes.push_back(*scope);
  }
  return principal;
}

}  // namespace

std::string_view name_of(Scope scope) {
  const auto row = std::ranges::find(kScopeNames, scope, [](const auto& pair) { return pair.first; });
  return row != kScopeNames.end() ? row->second : std::string_view();
}

std::optional<Scope> scope_of(std::string_view name) {
  const auto row = std::ranges::find(kScopeNames, name, [](const auto& pair) { return pair.second; });
  return row != kScopeNames.end() ? std::optional(row->first) : std::nullopt;
}

KeyRing::KeyRing(DatabaseDirectory& store, const Clock& clock, std::string secret)
    : store_(store), clock_(clock), secret_(std::move(secret)) {}

Result<std::unique_ptr<KeyRing>> KeyRing::open(DatabaseDirectory& store, const Clock& clock) {
  if (sodium_init() < 0) throw std::runtime_error("libsodium does not start");
  auto secret = store.server_secret();
  if (!secret) return secret.fault();
  std::unique_ptr<KeyRing> ring(new KeyRing(store, clock, *std::move(secret)));
  if (const auto loaded = ring->reload(); !loaded) return loaded.fault();
  return ring;
}

std::string KeyRing::hash_of(std::string_view key) const {
  std::string hash(kHashBytes, '\0');
  crypto_generichash(reinterpret_cast<unsigned char*>(hash.data()), hash.size(),
                     reinterpret_cast<const unsigned char*>(key.data()), key.size(),
                     reinterpret_cast<const unsigned char*>(secret_.data()), secret_.size());
  return hash;
}

Result<Principal> KeyRing::principal_of(std::string_view bearer_token) const {
  if (looks_like_session_token(bearer_token)) return principal_of_session(bearer_token);
  std::shared_ptr<const std::vector<KeyRecord>> keys;
  {
    const std::lock_guard lock(mutex_);
    keys = keys_;
  }
  const std::string hash = hash_of(bearer_token);
  const KeyRecord* found = nullptr;
  for (const KeyRecord& record : *keys) {  // to the end, whichever matches
    const bool same =
        record.keyed_hash.size() == hash.size() && sodium_memcmp(record.keyed_hash.data(), hash.data(), hash.size()) == 0;
    if (same) found = &record;
  }
  const Fault refused{FaultCode::kNotAuthenticated, "authorization",
                      bearer_token.empty() ? "no key was given" : "the key is not valid"};
  if (!found || found->revoked) return refused;
  if (found->expires_at && clock_.wall_now() >= *found->expires_at) return refused;
  return principal_from(*found);
}

// A token is worth what its key is worth at this moment, narrowed to tracking in its building.
Result<Principal> KeyRing::principal_of_session(std::string_view text) const {
  const auto token = unseal(text, secret_);
  const Fault refused{FaultCode::kNotAuthenticated, "authorization", "the session token is not valid"};
  if (!token) return refused;
  if (clock_.wall_now() >= token->expires_at) {
    return Fault{FaultCode::kNotAuthenticated, "authorization", "the session token has expired"};
  }
  std::shared_ptr<const std::vector<KeyRecord>> keys;
  {
    const std::lock_guard lock(mutex_);
    keys = keys_;
  }
  const auto found = std::ranges::find(*keys, token->key_id, &KeyRecord::id);
  if (found == keys->end() || found->revoked) return refused;
  Principal principal = principal_from(*found);
  if (std::ranges::find(principal.scopes, Scope::kTrack) == principal.scopes.end()) return refused;
  principal.scopes = {Scope::kTrack};
  if (token->building.value != 0) principal.building = token->building;
  principal.expires_at = token->expires_at;
  return principal;
}

Result<std::string> KeyRing::session_token(std::string_view bearer_key, BuildingId building, Duration lifetime) const {
  const auto principal = principal_of(bearer_key);
  if (!principal) return principal.fault();
  if (!principal->may(Scope::kTrack, principal->building)) {
    return Fault{FaultCode::kNotAllowed, "", "the key's scope does not cover this"};
  }
  if (building.value != 0 && principal->building.value != 0 && building != principal->building) {
    return Fault{FaultCode::kUnknownBuilding, "building", "there is no such building for this key"};
  }
  const UnixTime now = clock_.wall_now();
  UnixTime expires_at = now + std::min(lifetime, SessionToken::kLifeMost);
  if (principal->expires_at) expires_at = std::min(expires_at, *principal->expires_at);
  return seal({principal->key_id, building.value != 0 ? building : principal->building, expires_at}, secret_);
}

Result<IssuedKey> KeyRing::issue(std::string name, std::vector<Scope> scopes, BuildingId building,
                                 std::optional<UnixTime> expires_at, bool coarse) {
  std::array<unsigned char, kKeyBytes> random;
  randombytes_buf(random.data(), random.size());
  std::string text(sodium_base64_encoded_len(random.size(), sodium_base64_VARIANT_URLSAFE_NO_PADDING), '\0');
  sodium_bin2base64(text.data(), text.size(), random.data(), random.size(), sodium_base64_VARIANT_URLSAFE_NO_PADDING);
  text.pop_back();  // its final zero
  sodium_memzero(random.data(), random.size());

  IssuedKey issued{std::string(kKeyPrefix) + text, {}};
  KeyRecord record;
  record.name = std::move(name);
  record.keyed_hash = hash_of(issued.key);
  for (const Scope scope : scopes) record.scopes.emplace_back(name_of(scope));
  record.building = building;
  record.created_at = clock_.wall_now();
  record.expires_at = expires_at;
  record.coarse = coarse;
  auto stored = store_.add_key(std::move(record));
  if (!stored) return stored.fault();
  issued.record = *std::move(stored);
  if (const auto loaded = reload(); !loaded) return loaded.fault();
  return issued;
}

Result<void> KeyRing::revoke(std::uint64_t id) {
  const auto revoked = store_.revoke_key(id);
  if (!revoked) return revoked.fault();
  return reload();
}

std::vector<KeyRecord> KeyRing::keys() const {
  std::vector<KeyRecord> live;
  const std::lock_guard lock(mutex_);
  std::ranges::copy_if(*keys_, std::back_inserter(live), [](const KeyRecord& record) { return !record.revoked; });
  return live;
}

Result<void> KeyRing::reload() {
  auto keys = store_.keys();
  if (!keys) return keys.fault();
  auto fresh = std::make_shared<const std::vector<KeyRecord>>(*std::move(keys));
  const std::lock_guard lock(mutex_);
  keys_ = std::move(fresh);
  return {};
}

}  // namespace wayfuse
