#pragma once

#include <filesystem>

namespace wayfuse {

/// The mark of the one process that writes a database: an exclusive flock on `<file>.lock`, which the kernel drops with the
/// process, however it dies. Readers (backup tools, a shell) are not kept out: the write-ahead log serves them.
///
/// A sidecar, not the database itself: closing any descriptor of the database would drop SQLite's own POSIX locks on it.
class FileLock {
 public:
  /// Throws StoreError: kStoreBusy with the holder's process id, kStorageFull, kStorageFailed.
  explicit FileLock(const std::filesystem::path& database);
  FileLock(FileLock&& other) noexcept : descriptor_(other.descriptor_) { other.descriptor_ = -1; }
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock();

 private:
  int descriptor_ = -1;
};

}  // namespace wayfuse
