#include "db/server_database.hpp"

#include <sodium.h>

#include "db/audit_log.hpp"
#include "db/upkeep_table.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kSecretBytes = 32;

void write_secret(SqliteConnection& connection) {
  std::string secret(kSecretBytes, '\0');
  randombytes_buf(secret.data(), secret.size());
  connection.prepare("INSERT INTO secret (singleton, value) VALUES (1, ?)").bind_blob(1, secret).run();
  sodium_memzero(secret.data(), secret.size());
}

std::unique_ptr<SqliteConnection> open_or_create(const std::filesystem::path& file, const ConnectionSettings& settings) {
  if (std::filesystem::exists(file)) {
    try {
      return open_database(file, server_schema(), settings);
    } catch (const StoreError& error) {
      if (error.fault().code != FaultCode::kNotFound) throw;
      std::filesystem::remove(file);  // died during its creation: it holds nothing
    }
  }
  return create_database(file, server_schema(), settings, write_secret);
}

std::vector<std::string> read_scopes(SqliteConnection& connection, std::int64_t key) {
  std::vector<std::string> scopes;
  Statement select = connection.prepare("SELECT scope FROM api_key_scope WHERE key_id = ? ORDER BY scope");
  select.bind(1, key);
  while (select.step()) scopes.emplace_back(select.text(0));
  return scopes;
}

std::vector<KeyRecord> read_keys(SqliteConnection& connection) {
  Statement select = connection.prepare(
      "SELECT id, name, keyed_hash, building, created_at_us, expires_at_us, revoked, coarse FROM api_key ORDER BY id");
  std::vector<KeyRecord> keys;
  while (select.step()) {
    KeyRecord key;
    key.id = static_cast<std::uint64_t>(select.integer(0));
    key.name = select.text(1);
    key.keyed_hash = select.blob(2);
    key.scopes = read_scopes(connection, select.integer(0));
    key.building.value = static_cast<std::uint64_t>(select.integer(3));
    key.created_at = UnixTime(Duration(select.integer(4)));
    if (!select.is_null(5)) key.expires_at = UnixTime(Duration(select.integer(5)));
    key.revoked = select.integer(6) != 0;
    key.coarse = select.integer(7) != 0;
    keys.push_back(std::move(key));
  }
  return keys;
}

KeyRecord write_key(SqliteConnection& connection, KeyRecord key) {
  Transaction transaction(connection);
  Statement insert = connection.prepare(
      "INSERT INTO api_key (name, keyed_hash, building, created_at_us, expires_at_us, revoked, coarse) VALUES (?, ?, ?, ?, ?, ?, ?)");
  insert.bind_text(1, key.name).bind_blob(2, key.keyed_hash).bind(3, static_cast<std::int64_t>(key.building.value));
  insert.bind(4, std::int64_t{key.created_at.time_since_epoch().count()}).bind(6, std::int64_t{key.revoked}).bind(7, std::int64_t{key.coarse});
  if (key.expires_at) insert.bind(5, std::int64_t{key.expires_at->time_since_epoch().count()});
  insert.run();
  key.id = static_cast<std::uint64_t>(connection.last_insert_id());
  Statement scope = connection.prepare("INSERT INTO api_key_scope (key_id, scope) VALUES (?, ?)");
  for (const std::string& name : key.scopes) scope.bind(1, static_cast<std::int64_t>(key.id)).bind_text(2, name).run();
  transaction.commit();
  return key;
}

void set_revoked(SqliteConnection& connection, std::uint64_t id) {
  Statement update = connection.prepare("UPDATE api_key SET revoked = 1 WHERE id = ?");
  if (update.bind(1, static_cast<std::int64_t>(id)).run() == 0) {
    throw StoreError({FaultCode::kNotFound, "id", "there is no key " + std::to_string(id)});
  }
}

}  // namespace

ServerDatabase::ServerDatabase(const std::filesystem::path& folder, const ConnectionSettings& settings)
    : file_(folder / "server.sqlite"), settings_(settings), lock_(file_), sqlite_(open_or_create(file_, settings)) {}

template <typename Call>
auto ServerDatabase::run(Call&& call) -> Result<decltype(call(std::declval<SqliteConnection&>()))> {
  auto result = as_result([&] {
    if (sqlite_ == nullptr) sqlite_ = reopen_database(file_, settings_);
    return call(*sqlite_);
  });
  if (!result) sqlite_.reset();
  return result;
}

Result<std::string> ServerDatabase::secret() {
  return run([](SqliteConnection& connection) {
    Statement select = connection.prepare("SELECT value FROM secret");
    if (!select.step()) throw StoreError({FaultCode::kStoreCorrupt, connection.name(), "the server's secret is missing"});
    return std::string(select.blob(0));
  });
}

Result<std::vector<KeyRecord>> ServerDatabase::keys() { return run(read_keys); }

Result<KeyRecord> ServerDatabase::add_key(KeyRecord key) {
  return run([&](SqliteConnection& connection) { return write_key(connection, std::move(key)); });
}

Result<void> ServerDatabase::revoke_key(std::uint64_t id) {
  return run([&](SqliteConnection& connection) { set_revoked(connection, id); });
}

Result<void> ServerDatabase::note_removed(BuildingId id, UnixTime at) {
  return run([&](SqliteConnection& connection) {
    Transaction transaction(connection);
    Statement insert = connection.prepare("INSERT OR REPLACE INTO removed_building (id, at_us) VALUES (?, ?)");
    insert.bind(1, static_cast<std::int64_t>(id.value)).bind(2, std::int64_t{at.time_since_epoch().count()}).run();
    transaction.commit();
  });
}

Result<BuildingId> ServerDatabase::highest_removed() {
  return run([](SqliteConnection& connection) {
    return BuildingId{static_cast<std::uint64_t>(connection.integer("SELECT coalesce(max(id), 0) FROM removed_building"))};
  });
}

Result<void> ServerDatabase::audit(const std::vector<AuditRecord>& records) {
  return run([&](SqliteConnection& connection) { write_audit(connection, records); });
}

Result<std::vector<AuditRecord>> ServerDatabase::audited(const AuditQuery& query) {
  return run([&](SqliteConnection& connection) { return read_audit(connection, query); });
}

Result<std::uint64_t> ServerDatabase::forget_audit(UnixTime before) {
  return run([&](SqliteConnection& connection) { return wayfuse::forget_audit(connection, before); });
}

Result<void> ServerDatabase::note_upkeep(const UpkeepRecord& record) {
  return run([&](SqliteConnection& connection) { write_upkeep(connection, record); });
}

Result<std::vector<UpkeepRecord>> ServerDatabase::upkeep(BuildingId building) {
  return run([&](SqliteConnection& connection) { return read_upkeep(connection, building); });
}

Result<void> ServerDatabase::note_answered(const std::vector<AnsweredPostChange>& changes, UnixTime oldest) {
  return run([&](SqliteConnection& connection) { write_answered_posts(connection, changes, oldest); });
}

Result<std::vector<AnsweredPost>> ServerDatabase::answered_posts() { return run(read_answered_posts); }

}  // namespace wayfuse
