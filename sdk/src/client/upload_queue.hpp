#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "wayfuse/sdk/client.hpp"

namespace wayfuse {

const std::string& key_of(const SurveyUpload& upload);

/// Survey batches and walk parts kept until the server said they are durable. The key never changes, so that a repeat stores
/// nothing twice.
///
/// Thread: confined to its client.
class UploadQueue {
 public:
  UploadQueue(std::size_t most, Duration patience) : most_(most), patience_(patience) {}

  /// Refuses a bad key, a key that waits already, points that break the limits, a batch no frame can carry, a full queue.
  Result<void> push(SurveyUpload upload);
  /// The next batch due at `now`, at most four unanswered at a time; it counts as sent.
  const SurveyUpload* next(PhoneTime now);
  /// Not sent after all.
  void unsend(std::string_view key);
  /// A new connection: nothing is on its way any more.
  void rewind();
  /// Stored, or refused for good. False = no such batch waits.
  bool settle(std::string_view key);
  /// Refused for now: it goes out again at `at`.
  void retry(std::string_view key, PhoneTime at);
  /// When next() will have something at the earliest; absent = nothing waits.
  std::optional<PhoneTime> due() const;

  std::size_t size() const { return waiting_.size(); }

 private:
  struct Waiting {
    SurveyUpload upload;
    bool sent = false;
    PhoneTime due = PhoneTime::min();  // not before; once sent: when patience ends
  };
  Waiting* find(std::string_view key);

  static constexpr std::size_t kOnTheWay = 4;
  std::size_t most_;
  Duration patience_;
  std::deque<Waiting> waiting_;
};

}  // namespace wayfuse
