#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "db/answered_post_table.hpp"
#include "db/audit_record.hpp"
#include "db/database_directory.hpp"
#include "db/file_lock.hpp"
#include "db/schema.hpp"
#include "db/upkeep_record.hpp"

namespace wayfuse {

/// `server.sqlite`: the secret and the machine keys. Its lock also makes this process the folder's only writer.
/// Thread: confined to the writer thread.
class ServerDatabase {
 public:
  /// Opens the folder's server database, making it on first start. Throws StoreError.
  ServerDatabase(const std::filesystem::path& folder, const ConnectionSettings& settings);

  Result<std::string> secret();
  Result<std::vector<KeyRecord>> keys();
  Result<KeyRecord> add_key(KeyRecord key);
  Result<void> revoke_key(std::uint64_t id);
  Result<void> note_removed(BuildingId id, UnixTime at);
  Result<BuildingId> highest_removed();  ///< 0 = none
  /// All or none.
  Result<void> audit(const std::vector<AuditRecord>& records);
  Result<std::vector<AuditRecord>> audited(const AuditQuery& query);
  Result<std::uint64_t> forget_audit(UnixTime before);
  Result<void> note_upkeep(const UpkeepRecord& record);
  Result<std::vector<UpkeepRecord>> upkeep(BuildingId building);
  Result<void> note_answered(const std::vector<AnsweredPostChange>& changes, UnixTime oldest);
  Result<std::vector<AnsweredPost>> answered_posts();

 private:
  template <typename Call>
  auto run(Call&& call) -> Result<decltype(call(std::declval<SqliteConnection&>()))>;

  std::filesystem::path file_;
  ConnectionSettings settings_;
  FileLock lock_;
  std::unique_ptr<SqliteConnection> sqlite_;
};

}  // namespace wayfuse
