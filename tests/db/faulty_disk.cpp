#include "tests/db/faulty_disk.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace wayfuse::testing {
namespace {

constexpr std::uint64_t kSector = 512;

std::string next_name() {
  static std::atomic<int> made{0};
  return "faulty-disk-" + std::to_string(++made);
}

bool changes_disk(DiskCall call) {
  return call == DiskCall::kWrite || call == DiskCall::kTruncate || call == DiskCall::kSync || call == DiskCall::kDelete;
}

}  // namespace

std::string_view name_of(DiskCall call) {
  static constexpr std::array<std::string_view, kDiskCalls> names = {"open", "read", "write", "sync", "truncate", "delete",
                                                                     "access", "file size", "lock", "shm map", "shm lock"};
  return names[static_cast<std::size_t>(call)];
}

// SQLite allocates this with szOsFile bytes and never constructs it.
struct FaultyDisk::Open {
  sqlite3_file sqlite;
  FaultyDisk* disk;
  std::shared_ptr<File>* file;
  std::string* path;
  bool syncs_folder;  // a new journal or log: its first sync syncs the folder too
  bool deletes_on_close;
};

// Called with the mutex held.
int FaultyDisk::begin(DiskCall call) {
  ++counts_[static_cast<std::size_t>(call)];  // like errno, last_errno_ outlives calls that go well
  if (changes_disk(call)) {
    ++changes_;
    if (cut_at_ && changes_ >= *cut_at_) power_is_cut_ = true;
  }
  if (power_is_cut_) {
    last_errno_ = EIO;
    return SQLITE_IOERR;
  }
  if (!failure_ || failure_->call != call) return SQLITE_OK;
  ++failure_count_;
  if (failure_count_ < failure_->nth || (failure_count_ > failure_->nth && !failure_->sticks)) return SQLITE_OK;
  has_failed_ = true;
  last_errno_ = failure_->system_errno;
  return failure_->code;
}

void FaultyDisk::apply(const Change& change, std::string& content) {
  if (change.truncate) {
    content.resize(change.offset);
    return;
  }
  if (content.size() < change.offset + change.bytes.size()) content.resize(change.offset + change.bytes.size());
  content.replace(change.offset, change.bytes.size(), change.bytes);
}

void FaultyDisk::sync_folder() {
  for (auto& [path, file] : files_) file->on_platter = true;
  unlinked_.clear();
}

struct FaultyDisk::Calls {
  static Open& of(sqlite3_file* file) { return *reinterpret_cast<Open*>(file); }
  static FaultyDisk& disk(sqlite3_vfs* vfs) { return *static_cast<FaultyDisk*>(vfs->pAppData); }
  static File& file(Open& open) { return **open.file; }

  static int open(sqlite3_vfs* vfs, const char* path, sqlite3_file* into, int flags, int* out_flags) {
    FaultyDisk& self = disk(vfs);
    const std::lock_guard lock(self.mutex_);
    Open& open = of(into);
    open.sqlite.pMethods = nullptr;
    if (const int code = self.begin(DiskCall::kOpen)) return code;
    const std::string name = path != nullptr ? path : "temporary-" + std::to_string(self.counts_[0]);
    auto found = self.files_.find(name);
    if (found == self.files_.end()) {
      if ((flags & SQLITE_OPEN_CREATE) == 0) {
        self.last_errno_ = ENOENT;
        return SQLITE_CANTOPEN;
      }
      found = self.files_.emplace(name, std::make_shared<File>()).first;
    }
    open.disk = &self;
    open.file = new std::shared_ptr<File>(found->second);
    open.path = new std::string(name);
    open.syncs_folder = (flags & SQLITE_OPEN_CREATE) != 0 &&
                        (flags & (SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_SUPER_JOURNAL | SQLITE_OPEN_WAL)) != 0;
    open.deletes_on_close = (flags & SQLITE_OPEN_DELETEONCLOSE) != 0;
    ++found->second->open;
    open.sqlite.pMethods = methods();
    if (out_flags != nullptr) *out_flags = flags;
    return SQLITE_OK;
  }

  static int close(sqlite3_file* handle) {
    Open& open = of(handle);
    const std::lock_guard lock(open.disk->mutex_);
    --file(open).open;
    if (open.deletes_on_close) open.disk->files_.erase(*open.path);
    delete open.file;
    delete open.path;
    return SQLITE_OK;
  }

  static int read(sqlite3_file* handle, void* into, int size, sqlite3_int64 offset) {
    Open& open = of(handle);
    const std::lock_guard lock(open.disk->mutex_);
    if (const int code = open.disk->begin(DiskCall::kRead)) return code;
    const std::string& now = file(open).now;
    const auto from = static_cast<std::size_t>(offset);
    const std::size_t there = from >= now.size() ? 0 : std::min(now.size() - from, static_cast<std::size_t>(size));
    if (there > 0) std::memcpy(into, now.data() + from, there);
    if (there == static_cast<std::size_t>(size)) return SQLITE_OK;
    std::memset(static_cast<char*>(into) + there, 0, static_cast<std::size_t>(size) - there);
    return SQLITE_IOERR_SHORT_READ;
  }

  static int change(sqlite3_file* handle, DiskCall call, Change change) {
    Open& open = of(handle);
    const std::lock_guard lock(open.disk->mutex_);
    if (const int code = open.disk->begin(call)) {
      // A write that fails has done a part of its work.
      if (!change.truncate && !open.disk->power_is_cut_) {
        change.bytes.resize(change.bytes.size() / 2);
        apply(change, file(open).now);
        file(open).unsynced.push_back(std::move(change));
      }
      return code;
    }
    apply(change, file(open).now);
    file(open).unsynced.push_back(std::move(change));
    return SQLITE_OK;
  }
  static int write(sqlite3_file* handle, const void* from, int size, sqlite3_int64 offset) {
    return change(handle, DiskCall::kWrite,
                  {static_cast<std::uint64_t>(offset), std::string(static_cast<const char*>(from), static_cast<std::size_t>(size)), false});
  }
  static int truncate(sqlite3_file* handle, sqlite3_int64 size) {
    return change(handle, DiskCall::kTruncate, {static_cast<std::uint64_t>(size), "", true});
  }

  static int sync(sqlite3_file* handle, int) {
    Open& open = of(handle);
    const std::lock_guard lock(open.disk->mutex_);
    if (const int code = open.disk->begin(DiskCall::kSync)) {
      // As Linux does: after a failed fsync the pages count as clean. What was to be written may never be.
      if (!open.disk->power_is_cut_) file(open).unsynced.clear();
      return code;
    }
    for (const Change& change : file(open).unsynced) apply(change, file(open).platter);
    file(open).unsynced.clear();
    if (open.syncs_folder) open.disk->sync_folder();
    open.syncs_folder = false;
    return SQLITE_OK;
  }

  static int file_size(sqlite3_file* handle, sqlite3_int64* size) {
    Open& open = of(handle);
    const std::lock_guard lock(open.disk->mutex_);
    if (const int code = open.disk->begin(DiskCall::kFileSize)) return code;
    *size = static_cast<sqlite3_int64>(file(open).now.size());
    return SQLITE_OK;
  }

  // One connection a file at a time is what the store promises, so file locks only count and fail.
  static int lock(sqlite3_file* handle, int) {
    Open& open = of(handle);
    const std::lock_guard guard(open.disk->mutex_);
    return open.disk->begin(DiskCall::kLock);
  }
  static int unlock(sqlite3_file*, int) { return SQLITE_OK; }
  static int check_reserved(sqlite3_file*, int* reserved) {
    *reserved = 0;
    return SQLITE_OK;
  }
  static int control(sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; }
  static int sector_size(sqlite3_file*) { return static_cast<int>(kSector); }
  static int characteristics(sqlite3_file*) { return SQLITE_IOCAP_POWERSAFE_OVERWRITE; }

  static int shm_map(sqlite3_file* handle, int region, int size, int extend, void volatile** out) {
    Open& open = of(handle);
    const std::lock_guard lock(open.disk->mutex_);
    *out = nullptr;
    if (const int code = open.disk->begin(DiskCall::kShmMap)) return code;
    auto& regions = file(open).shared_memory;
    if (static_cast<std::size_t>(region) >= regions.size() && extend == 0) return SQLITE_OK;
    while (regions.size() <= static_cast<std::size_t>(region)) regions.push_back(std::make_unique<char[]>(static_cast<std::size_t>(size)));
    *out = regions[static_cast<std::size_t>(region)].get();
    return SQLITE_OK;
  }

  static int shm_lock(sqlite3_file* handle, int first, int count, int flags) {
    Open& open = of(handle);
    const std::lock_guard lock(open.disk->mutex_);
    const bool unlocks = (flags & SQLITE_SHM_UNLOCK) != 0;
    if (!unlocks) {
      if (const int code = open.disk->begin(DiskCall::kShmLock)) return code;
    }
    const bool exclusive = (flags & SQLITE_SHM_EXCLUSIVE) != 0;
    const auto range = [&](auto visit) {
      for (int i = first; i < first + count; ++i) visit(file(open).shared_locks[static_cast<std::size_t>(i)]);
    };
    bool taken = false;
    if (!unlocks) range([&](SharedLock& slot) { taken |= slot.exclusive != nullptr || (exclusive && slot.shared > 0); });
    if (taken) return SQLITE_BUSY;
    range([&](SharedLock& slot) {
      if (exclusive) slot.exclusive = unlocks ? nullptr : handle;
      if (!exclusive) slot.shared += unlocks ? -1 : 1;
    });
    return SQLITE_OK;
  }
  static void shm_barrier(sqlite3_file*) { std::atomic_thread_fence(std::memory_order_seq_cst); }
  static int shm_unmap(sqlite3_file* handle, int) {
    Open& open = of(handle);
    const std::lock_guard lock(open.disk->mutex_);
    if (file(open).open > 1) return SQLITE_OK;
    file(open).shared_memory.clear();  // the last connection takes the index with it
    file(open).shared_locks = {};
    return SQLITE_OK;
  }

  static const sqlite3_io_methods* methods() {
    static const sqlite3_io_methods table = {2, close, read, write, truncate, sync, file_size, lock, unlock, check_reserved, control,
                                             sector_size, characteristics, shm_map, shm_lock, shm_barrier, shm_unmap, nullptr, nullptr};
    return &table;
  }

  static int remove(sqlite3_vfs* vfs, const char* path, int sync_folder) {
    FaultyDisk& self = disk(vfs);
    const std::lock_guard lock(self.mutex_);
    if (const int code = self.begin(DiskCall::kDelete)) return code;
    const auto found = self.files_.find(path);
    if (found == self.files_.end()) return SQLITE_IOERR_DELETE_NOENT;
    if (found->second->on_platter) self.unlinked_[path] = found->second;
    self.files_.erase(found);
    if (sync_folder != 0) self.sync_folder();
    return SQLITE_OK;
  }

  static int access(sqlite3_vfs* vfs, const char* path, int, int* there) {
    FaultyDisk& self = disk(vfs);
    const std::lock_guard lock(self.mutex_);
    if (const int code = self.begin(DiskCall::kAccess)) return code;
    const auto found = self.files_.find(path);
    *there = found != self.files_.end() ? 1 : 0;
    return SQLITE_OK;
  }

  static int full_path(sqlite3_vfs*, const char* path, int size, char* out) {
    sqlite3_snprintf(size, out, "%s", path);
    return SQLITE_OK;
  }
  static int last_error(sqlite3_vfs* vfs, int, char*) { return disk(vfs).last_errno_; }
};

FaultyDisk::FaultyDisk() : name_(next_name()), vfs_(std::make_unique<sqlite3_vfs>(*sqlite3_vfs_find(nullptr))) {
  vfs_->iVersion = 2;
  vfs_->szOsFile = sizeof(Open);
  vfs_->pNext = nullptr;
  vfs_->zName = name_.c_str();
  vfs_->pAppData = this;
  vfs_->xOpen = Calls::open;
  vfs_->xDelete = Calls::remove;
  vfs_->xAccess = Calls::access;
  vfs_->xFullPathname = Calls::full_path;
  vfs_->xGetLastError = Calls::last_error;
  if (sqlite3_vfs_register(vfs_.get(), 0) != SQLITE_OK) throw std::runtime_error("sqlite3_vfs_register");
}

FaultyDisk::~FaultyDisk() { sqlite3_vfs_unregister(vfs_.get()); }

void FaultyDisk::fail(const DiskFailure& failure) {
  const std::lock_guard lock(mutex_);
  failure_ = failure;
  failure_count_ = 0;
  has_failed_ = false;
}

void FaultyDisk::heal() {
  const std::lock_guard lock(mutex_);
  failure_.reset();
}

bool FaultyDisk::has_failed() const {
  const std::lock_guard lock(mutex_);
  return has_failed_;
}

std::uint64_t FaultyDisk::calls(DiskCall call) const {
  const std::lock_guard lock(mutex_);
  return counts_[static_cast<std::size_t>(call)];
}

void FaultyDisk::cut_power_at(std::uint64_t nth) {
  const std::lock_guard lock(mutex_);
  cut_at_ = changes_ + nth;
}

bool FaultyDisk::power_is_cut() const {
  const std::lock_guard lock(mutex_);
  return power_is_cut_;
}

std::uint64_t FaultyDisk::changes() const {
  const std::lock_guard lock(mutex_);
  return changes_;
}

void FaultyDisk::place(const std::string& path, std::string content) {
  const std::lock_guard lock(mutex_);
  const auto file = std::make_shared<File>();
  file->now = file->platter = std::move(content);
  file->on_platter = true;
  files_[path] = file;
}

std::string FaultyDisk::content(const std::string& path) const {
  const std::lock_guard lock(mutex_);
  const auto found = files_.find(path);
  return found == files_.end() ? std::string() : found->second->now;
}

void FaultyDisk::restore_power(Random& luck) {
  const std::lock_guard lock(mutex_);
  // A disk without a write cache keeps nothing unsynced, one with a large one keeps most: every share of luck is tried.
  const std::uint64_t kept_of_four = luck.below(5);
  for (auto& [path, file] : unlinked_) {
    if (files_.count(path) == 0 && luck.below(2) == 0) files_[path] = file;  // its deletion never reached the folder
  }
  unlinked_.clear();
  std::erase_if(files_, [&](const auto& entry) { return !entry.second->on_platter && luck.below(2) == 0; });
  for (auto& [path, file] : files_) {
    if (file->open != 0) throw std::logic_error(path + " is open while the power is restored");
    for (Change& change : file->unsynced) {
      if (change.truncate) {
        if (luck.below(4) < kept_of_four) apply(change, file->platter);
        continue;
      }
      for (std::uint64_t at = 0; at < change.bytes.size(); at += kSector) {
        if (luck.below(4) >= kept_of_four) continue;
        apply({change.offset + at, change.bytes.substr(at, kSector), false}, file->platter);
      }
    }
    file->unsynced.clear();
    file->now = file->platter;
    file->shared_memory.clear();
    file->shared_locks = {};
    file->on_platter = true;
  }
  cut_at_.reset();
  power_is_cut_ = false;
}

}  // namespace wayfuse::testing
