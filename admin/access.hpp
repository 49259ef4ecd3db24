#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "admin/router.hpp"
#include "db/database_directory.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// The names scopes have in the store and in the API; kPublic has none.
std::string_view name_of(Scope scope);
std::optional<Scope> scope_of(std::string_view name);

/// A fresh key, the only time it can be seen.
struct IssuedKey {
  std::string key;      ///< `wf_` and 43 characters of base64url: 256 random bits
  KeyRecord record;
};

/// Machine keys: 256 random bits, stored as BLAKE2b-256 keyed with the server's secret, compared in constant time over all
/// keys [SAFETY C1].
///
/// Thread: any; one mutex over the table, never held while calling out.
class KeyRing final : public Access {
 public:
  /// Reads the secret and the keys from the store.
  static Result<std::unique_ptr<KeyRing>> open(DatabaseDirectory& store, const Clock& clock);

  Result<Principal> principal_of(std::string_view bearer_token) const override;
  Result<IssuedKey> issue(std::string name, std::vector<Scope> scopes, BuildingId building, std::optional<UnixTime> expires_at,
                         bool coarse = false);
  Result<void> revoke(std::uint64_t id);
  /// A token for one phone's sessions in the name of this key: see SessionToken. A building the key does not cover is
  /// kUnknownBuilding; 0 = all the key covers. Never outlives the key.
  Result<std::string> session_token(std::string_view bearer_key, BuildingId building, Duration lifetime) const;
  /// Without the revoked ones.
  std::vector<KeyRecord> keys() const;
  bool empty() const { return keys().empty(); }

 private:
  KeyRing(DatabaseDirectory& store, const Clock& clock, std::string secret);
  std::string hash_of(std::string_view key) const;
  Result<Principal> principal_of_session(std::string_view token) const;
  Result<void> reload();

  DatabaseDirectory& store_;
  const Clock& clock_;
  const std::string secret_;
  mutable std::mutex mutex_;
  std::shared_ptr<const std::vector<KeyRecord>> keys_;
};

}  // namespace wayfuse
