#pragma once

#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "admin/http.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Makes a POST with an `Idempotency-Key` happen once: the same key, path and body get the answer the first one got, another
/// body gets kIdempotencyConflict, and one that comes while the first is under way is told so.
///
/// In memory, for a day and the newest 4,096: a restart forgets. Answers from 500 on are not kept, so that a retry tries
/// again. Thread: any; one mutex, not held while calling out.
class IdempotencyLedger {
 public:
  explicit IdempotencyLedger(const Clock& clock) : clock_(clock) {}

  /// The respond to go on with, which keeps the answer; absent = this request is answered already.
  std::optional<Respond> begin(const Request& request, Respond respond);

 private:
  static constexpr Duration kKept = std::chrono::hours(24);
  static constexpr std::size_t kMost = 4096;
  static constexpr std::size_t kLongestBody = 256 * 1024;
  struct Entry {
    std::string body_hash;
    std::optional<Response> answer;    ///< absent = under way
    ServerTime at;
  };
  void finish(const std::string& name, const Response& response);
  void forget_old();

  const Clock& clock_;
  std::mutex mutex_;
  std::map<std::string, Entry> entries_;
  std::deque<std::string> oldest_first_;
};

}  // namespace wayfuse
