#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "wayfuse/proto/random.hpp"

struct sqlite3_vfs;

/// A disk in memory for SQLite that forgets what was not synced when its power is cut, and fails when told to.
namespace wayfuse::testing {

enum class DiskCall : std::uint8_t { kOpen, kRead, kWrite, kSync, kTruncate, kDelete, kAccess, kFileSize, kLock, kShmMap, kShmLock };
inline constexpr std::size_t kDiskCalls = 11;
std::string_view name_of(DiskCall call);

/// The `nth` call of a kind (from 1) answers `code`; with `sticks` so do all of that kind after it, until heal().
struct DiskFailure {
  DiskCall call = DiskCall::kWrite;
  std::uint64_t nth = 1;
  int code = 0;            ///< extended SQLite result code
  int system_errno = 0;    ///< what sqlite3_system_errno() says of it
  bool sticks = false;
};

/// Registered as the SQLite VFS `name()` while it lives. Model: a write reaches the platter at the next sync of its file; a file's
/// coming and going does at the next sync of its folder, which SQLite's own unix VFS does with the first sync of a new journal or
/// log. When the power is cut, each write not yet synced is kept, lost or torn at 512 bytes, at random and out of order.
/// Thread: any.
class FaultyDisk {
 public:
  FaultyDisk();
  ~FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;
  const std::string& name() const { return name_; }

  void fail(const DiskFailure& failure);
  void heal();
  /// Whether the failure asked for has happened.
  bool has_failed() const;
  std::uint64_t calls(DiskCall call) const;

  /// From the `nth` write, truncate, sync or delete on (counted from now) nothing reaches the disk and every call fails.
  void cut_power_at(std::uint64_t nth);
  bool power_is_cut() const;
  std::uint64_t changes() const;     ///< writes, truncates, syncs and deletes so far
  /// Power again: what was synced is there, the rest as luck has it. No file may be open.
  void restore_power(Random& luck);

  /// Puts a file there, durable.
  void place(const std::string& path, std::string content);
  /// The file as a reader would see it now, for checks from outside; empty if there is none.
  std::string content(const std::string& path) const;

 private:
  struct Change {
    std::uint64_t offset = 0;        ///< of a write; the new size of a truncate
    std::string bytes;
    bool truncate = false;
  };
  struct SharedLock {
    int shared = 0;
    const void* exclusive = nullptr;
  };
  struct File {
    std::string now;                 ///< as readers see it
    std::string platter;             ///< as of the last sync
    std::vector<Change> unsynced;
    bool on_platter = false;         ///< its folder entry is durable
    int open = 0;
    std::vector<std::unique_ptr<char[]>> shared_memory;
    std::array<SharedLock, 8> shared_locks{};
  };
  struct Open;   // an open file, as SQLite's sqlite3_file
  struct Calls;  // the C functions

  int begin(DiskCall call);          ///< 0, or the code to fail with
  static void apply(const Change& change, std::string& content);
  void sync_folder();

  const std::string name_;
  std::unique_ptr<sqlite3_vfs> vfs_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<File>> files_;
  std::map<std::string, std::shared_ptr<File>> unlinked_;  ///< deleted, but their folder was not synced since
  std::array<std::uint64_t, kDiskCalls> counts_{};
  std::uint64_t changes_ = 0;
  std::optional<DiskFailure> failure_;
  std::uint64_t failure_count_ = 0;  ///< calls of the failing kind since fail()
  bool has_failed_ = false;
  std::optional<std::uint64_t> cut_at_;
  bool power_is_cut_ = false;
  int last_errno_ = 0;
};

}  // namespace wayfuse::testing
