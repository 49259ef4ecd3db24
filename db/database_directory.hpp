#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "db/answered_post.hpp"
#include "db/audit_record.hpp"
#include "db/building_database.hpp"
#include "db/upkeep_record.hpp"

namespace wayfuse {

/// A machine key as stored: never the key itself [SAFETY C1].
struct KeyRecord {
  std::uint64_t id = 0;
  std::string name;
  std::string keyed_hash;                ///< BLAKE2b-256 under the server's secret, raw 32 bytes
  std::vector<std::string> scopes;       ///< `survey`, `track`, `observe`, `admin`
  BuildingId building;                   ///< 0 = all buildings
  UnixTime created_at;
  std::optional<UnixTime> expires_at;
  bool revoked = false;
  bool coarse = false;                   ///< observes zones, never coordinates [C19]
};

/// The server's data folder: `server.sqlite` (keys, secret) and one `building-<id>.sqlite` each [C2]; and the one thread
/// that owns every connection to them.
///
/// Thread: any; each call is posted to the writer thread and the callback runs there. Survey batches that arrive within
/// 5 ms or 256 points of each other are committed together; a lone surveyor does not wait.
/// Callbacks must not throw; they may call back into the directory.
class DatabaseDirectory {
 public:
  struct Options {
    std::string vfs;                     ///< SQLite VFS name; empty = the default one
    /// False: no thread; each call and its callback run at once on the caller's thread, one commit an upload. For the
    /// deterministic simulation and for single-threaded tools.
    bool own_thread = true;
    Duration gather_for = std::chrono::milliseconds(5);  ///< longest an upload waits for others to share its commit
    std::size_t group_points = 256;                      ///< points in one commit
    std::size_t most_waiting_points = 65'536;            ///< beyond it uploads are refused with kOverloaded
  };
  /// Opens the folder (making it when missing), migrates and quick_checks every database. A building that is corrupt is
  /// quarantined: its files are kept under `building-<id>.sqlite.corrupt`, the others open. kStoreBusy when another process
  /// has the folder.
  static Result<std::unique_ptr<DatabaseDirectory>> open(const std::filesystem::path& folder, const Options& options);
  virtual ~DatabaseDirectory() = default;

  /// Runs `task` on the writer thread with that building's database; kUnknownBuilding if there is none.
  virtual void with_building(BuildingId id, std::function<void(Result<BuildingDatabase*>)> task) = 0;
  virtual void store(BuildingId id, SurveyBatch batch, std::function<void(Result<SurveyAck>)> done) = 0;
  /// Id 0 = the next free one. kConflict when the id is taken, by a quarantined building too.
  virtual void create_building(BuildingRecord building, std::function<void(Result<BuildingRecord>)> done) = 0;

  /// Takes a building from a backup: copied, migrated, verified row by row, then put in place under its own number.
  /// kConflict when that building is in use (a quarantined one is replaced, its files stay aside), kStoreCorrupt when the
  /// backup is not sound.
  virtual void restore_building(std::filesystem::path backup, std::function<void(Result<BuildingRecord>)> done) = 0;

  /// Removes a building for good, with all its files, a quarantined one too. Its number is never given again; a backup of it
  /// can be restored under it. kUnknownBuilding if there is none.
  virtual void remove_building(BuildingId id, UnixTime at, std::function<void(Result<void>)> done) = 0;
  /// A path inside the folder for a file in passing, a backup on its way out or in: nobody has it yet, and what is left of it
  /// after a crash is removed at the next start.
  virtual std::filesystem::path passing_file() = 0;

  /// Snapshot of what is there, taken under a mutex; ascending ids.
  virtual std::vector<BuildingId> buildings() const = 0;
  /// Buildings that cannot be used, with the reason; one whose disk was merely full is tried again at its next use.
  virtual std::vector<std::pair<BuildingId, Fault>> quarantined() const = 0;

  virtual Result<std::string> server_secret() = 0;       ///< 32 bytes, made on first start
  virtual Result<std::vector<KeyRecord>> keys() = 0;
  virtual Result<KeyRecord> add_key(KeyRecord key) = 0;  ///< id is assigned
  virtual Result<void> revoke_key(std::uint64_t id) = 0;

  /// Adds a line to the audit; lines that arrive while the disk is busy share a commit. `done` runs once it is durable: answer
  /// an observer after it.
  virtual void audit(AuditRecord record, std::function<void(Result<void>)> done) = 0;
  virtual Result<std::vector<AuditRecord>> audited(const AuditQuery& query) = 0;
  /// Retention: forgets older lines, answers how many.
  virtual Result<std::uint64_t> forget_audit(UnixTime before) = 0;

  /// Writes down that a building was backed up or verified; of each the newest 100 stay. `done` runs once it is durable.
  virtual void note_upkeep(UpkeepRecord record, std::function<void(Result<void>)> done) = 0;
  virtual Result<std::vector<UpkeepRecord>> upkeep(BuildingId building) = 0;   ///< newest first

  /// Writes down a POST that is to happen once, replacing what was known of it; without a record it is forgotten. In order; what began
  /// before `oldest` goes. `done` runs once it is durable.
  virtual void note_answered(std::string name, std::optional<AnsweredPost> record, UnixTime oldest, std::function<void(Result<void>)> done) = 0;
  virtual Result<std::vector<AnsweredPost>> answered_posts() = 0;   ///< ascending by time

  /// Finishes what is queued, checkpoints, closes. Every later call is answered kDraining, on the caller's thread.
  virtual void close() = 0;
};

}  // namespace wayfuse
