#include "db/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "db/sqlite.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kProcessBytes = 20;

std::string holder(int descriptor) {
  char text[kProcessBytes] = {};
  const ssize_t length = ::pread(descriptor, text, sizeof text, 0);
  const std::string padded(text, length > 0 ? static_cast<std::size_t>(length) : 0);
  const std::string process = padded.substr(0, padded.find(' '));
  return process.empty() ? "another process" : "process " + process;
}

}  // namespace

FileLock::FileLock(const std::filesystem::path& database) {
  const std::string file = database.string() + ".lock";
  const std::string name = database.filename().string();
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor_ < 0 && errno == EROFS) descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) {
    const bool full = errno == ENOSPC || errno == EDQUOT || errno == EROFS;
    throw StoreError({full ? FaultCode::kStorageFull : FaultCode::kStorageFailed, name,
                      "cannot open its lock file: " + std::string(std::strerror(errno))});
  }
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const Fault busy{FaultCode::kStoreBusy, name, holder(descriptor_) + " already writes this database"};
    ::close(descriptor_);
    throw StoreError(busy);
  }
  // Only to name the holder in the other process's fault; the lock itself is the kernel's. Padded instead of truncated: ext4
  // flushes a truncated file when it is closed.
  std::string process = std::to_string(::getpid());
  process.resize(kProcessBytes, ' ');
  (void)!::pwrite(descriptor_, process.data(), process.size(), 0);
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace wayfuse
