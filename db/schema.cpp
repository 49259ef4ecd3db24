#include "db/schema.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "db/migrations.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

constexpr std::int32_t kBuildingApplication = 0x57464275;  // "WFBu"
constexpr std::int32_t kServerApplication = 0x57465365;    // "WFSe"

void set_up(SqliteConnection& connection, const ConnectionSettings& settings) {
  if (connection.text("PRAGMA journal_mode = WAL") != "wal") {
    throw StoreError({FaultCode::kStorageFailed, connection.name(), "cannot keep a write-ahead log here"});
  }
  connection.execute(settings.synchronous_normal ? "PRAGMA synchronous = NORMAL" : "PRAGMA synchronous = FULL");
  connection.execute("PRAGMA foreign_keys = ON");
  // A group's savepoints would spill to a temporary file: on a read-only root there is no place for it, and points do not belong there.
  connection.execute("PRAGMA temp_store = MEMORY");
  connection.execute("PRAGMA wal_autocheckpoint = " + std::to_string(settings.checkpoint_pages));
  // Reads stay off mmap: an I/O error would be a signal instead of a fault.
  connection.execute("PRAGMA mmap_size = 0");
}

// A first, cheap look: is this ours, and of which version?
std::int64_t version_of(SqliteConnection& connection, const Schema& schema) {
  const std::int64_t version = connection.integer("PRAGMA user_version");
  if (version == 0 && connection.integer("SELECT count(*) FROM sqlite_schema") == 0) {
    throw StoreError({FaultCode::kNotFound, connection.name(), "its creation was never finished: it holds nothing"});
  }
  if (connection.integer("PRAGMA application_id") != schema.application_id) {
    throw StoreError({FaultCode::kStoreCorrupt, connection.name(), "not a wayfuse " + std::string(schema.name) + " database"});
  }
  const auto known = static_cast<std::int64_t>(schema.steps.size());
  if (version > known) {
    throw StoreError({FaultCode::kStoreTooNew, connection.name(),
                      "schema version " + std::to_string(version) + ", this wayfuse knows up to " + std::to_string(known)});
  }
  return version;
}

void check_pages(SqliteConnection& connection) {
  const std::string verdict = connection.text("PRAGMA quick_check(1)");
  if (verdict != "ok") throw StoreError({FaultCode::kStoreCorrupt, connection.name(), verdict});
}

void migrate(SqliteConnection& connection, const fs::path& file, const Schema& schema, const ConnectionSettings& settings,
             std::int64_t version) {
  const fs::path copy = file.string() + ".v" + std::to_string(version);
  fs::remove(copy);  // of an attempt that did not reach its end
  connection.back_up_to(copy, settings.vfs);
  for (; version < static_cast<std::int64_t>(schema.steps.size()); ++version) {
    Transaction transaction(connection);
    run_steps(connection, {schema.name, schema.application_id, schema.steps.first(static_cast<std::size_t>(version) + 1)}, version);
    transaction.commit();
  }
}

}  // namespace

const Schema& building_schema() {
  static const Schema schema{"building", kBuildingApplication, building_migrations()};
  return schema;
}

const Schema& server_schema() {
  static const Schema schema{"server", kServerApplication, server_migrations()};
  return schema;
}

std::unique_ptr<SqliteConnection> make_empty_database(const fs::path& file, const ConnectionSettings& settings) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0) {
    const std::string cause = std::strerror(errno);
    const bool full = errno == ENOSPC || errno == EDQUOT || errno == EROFS;
    const FaultCode code = errno == EEXIST ? FaultCode::kConflict : full ? FaultCode::kStorageFull : FaultCode::kStorageFailed;
    throw StoreError({code, file.filename().string(), "cannot be made: " + cause});
  }
  ::close(descriptor);
  auto connection = std::make_unique<SqliteConnection>(file, settings.vfs, SqliteConnection::Mode::kCreate);
  set_up(*connection, settings);
  return connection;
}

void run_steps(SqliteConnection& connection, const Schema& schema, std::int64_t version) {
  for (std::size_t step = static_cast<std::size_t>(version); step < schema.steps.size(); ++step) {
    connection.execute(std::string(schema.steps[step]));
  }
  connection.execute("PRAGMA application_id = " + std::to_string(schema.application_id));
  connection.execute("PRAGMA user_version = " + std::to_string(schema.steps.size()));
}

std::unique_ptr<SqliteConnection> open_database(const fs::path& file, const Schema& schema, const ConnectionSettings& settings) {
  make_log_durable(file, settings.vfs);
  auto connection = std::make_unique<SqliteConnection>(file, settings.vfs, SqliteConnection::Mode::kReadWrite);
  try {
    const std::int64_t version = version_of(*connection, schema);
    check_pages(*connection);
    set_up(*connection, settings);
    if (version < static_cast<std::int64_t>(schema.steps.size())) migrate(*connection, file, schema, settings, version);
  } catch (const StoreError& error) {
    if (error.fault().code == FaultCode::kStoreCorrupt) connection->keep_log_on_close();
    throw;
  }
  return connection;
}

std::unique_ptr<SqliteConnection> reopen_database(const fs::path& file, const ConnectionSettings& settings) {
  make_log_durable(file, settings.vfs);
  auto connection = std::make_unique<SqliteConnection>(file, settings.vfs, SqliteConnection::Mode::kReadWrite);
  set_up(*connection, settings);
  return connection;
}

}  // namespace wayfuse
