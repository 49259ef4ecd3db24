#pragma once

#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "admin/http.hpp"
#include "db/database_directory.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Makes a POST with an `Idempotency-Key` happen once: the same key, path and body get the answer the first one got, another
/// body gets kIdempotencyConflict, and one that comes while the first is under way is told so.
///
/// For a day and the newest 4,096, also over a restart: that it began is queued at the store before the handler asks the store for
/// anything, and its answer goes out once it is written down. Of answers that must not be stored (no-store: they hold a secret) and of
/// long ones only the fact is written. A server that ended in between is found out: then nobody knows whether it happened, and a retry
/// is told so. A store that does not take a note costs its memory over the restart, not the answer. Answers from 500 on are not kept, so
/// that a retry tries again.
///
/// Thread: any; one mutex, not held while calling out.
class IdempotencyLedger {
 public:
  IdempotencyLedger(DatabaseDirectory& store, const Clock& clock) : store_(store), clock_(clock) {}

  /// Reads what an earlier run wrote down; before the first request.
  Result<void> load();
  /// The respond to go on with, which keeps the answer; absent = this request is answered already.
  std::optional<Respond> begin(const Request& request, Respond respond);

 private:
  static constexpr Duration kKept = std::chrono::hours(24);
  static constexpr std::size_t kMost = 4096;
  static constexpr std::size_t kLongestBody = 256 * 1024;
  static constexpr std::size_t kLongestWritten = 32 * 1024;
  struct Entry {
    std::string body_hash;
    std::optional<Response> answer;    ///< absent = under way
    UnixTime at;
  };
  void finish(const std::string& name, const std::string& body_hash, UnixTime at, Response response, const Respond& respond);
  void forget_old();

  DatabaseDirectory& store_;
  const Clock& clock_;
  std::mutex mutex_;
  std::map<std::string, Entry> entries_;
  std::deque<std::string> oldest_first_;
};

}  // namespace wayfuse
