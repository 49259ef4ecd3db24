#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "db/sqlite.hpp"

namespace wayfuse {

/// The steps that lead an empty file to today's schema: step i makes version i + 1 [C22].
struct Schema {
  std::string_view name;            ///< for faults, like `building`
  std::int32_t application_id;      ///< tells our files from foreign ones
  std::span<const std::string_view> steps;
};

const Schema& building_schema();
const Schema& server_schema();

/// What every connection of ours is: where, through which VFS, how durable.
struct ConnectionSettings {
  std::string vfs;
  bool synchronous_normal = false;
  int checkpoint_pages = 1000;
};

/// Makes a new file with today's schema in it; kConflict when there is one already. `fill` runs in the same transaction, so
/// that a file either holds its first rows or holds nothing.
template <typename Fill>
std::unique_ptr<SqliteConnection> create_database(const std::filesystem::path& file, const Schema& schema,
                                                  const ConnectionSettings& settings, Fill&& fill);

/// Opens an existing file, checks every page, brings it to today's schema after copying it to `<file>.v<old>`.
/// Throws StoreError: kNotFound for a file whose creation never finished, kStoreTooNew, kStoreCorrupt, and what the disk says.
std::unique_ptr<SqliteConnection> open_database(const std::filesystem::path& file, const Schema& schema,
                                                const ConnectionSettings& settings);
/// The same without checks, for a connection dropped after a fault.
std::unique_ptr<SqliteConnection> reopen_database(const std::filesystem::path& file, const ConnectionSettings& settings);

// ---------------------------------------------------------------- what the template needs

/// Makes the empty file, readable by its owner only.
std::unique_ptr<SqliteConnection> make_empty_database(const std::filesystem::path& file, const ConnectionSettings& settings);
/// Runs the steps after `version`, inside the caller's transaction.
void run_steps(SqliteConnection& connection, const Schema& schema, std::int64_t version);

template <typename Fill>
std::unique_ptr<SqliteConnection> create_database(const std::filesystem::path& file, const Schema& schema,
                                                  const ConnectionSettings& settings, Fill&& fill) {
  std::unique_ptr<SqliteConnection> connection = make_empty_database(file, settings);
  Transaction transaction(*connection);
  run_steps(*connection, schema, 0);
  fill(*connection);
  transaction.commit();
  return connection;
}

}  // namespace wayfuse
