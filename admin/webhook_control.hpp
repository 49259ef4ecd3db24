#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "db/webhook_record.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// How a webhook does; counts since the server began.
struct WebhookState {
  std::uint64_t waiting = 0;             ///< events queued or under way
  std::uint64_t delivered = 0;
  std::uint64_t failed_attempts = 0;
  std::uint64_t dead = 0;                ///< letters kept
  std::uint64_t dropped = 0;             ///< dead letters that had to make room
  std::string last_failure;              ///< empty = none yet
};

/// An event that could not be delivered. In memory only [SAFETY C19].
struct DeadLetter {
  std::string event_id;
  UnixTime at;                           ///< of the event
  unsigned attempts = 0;
  std::string failure;                   ///< of the last attempt
};

/// One try at posting an event. In memory only [SAFETY C19]: which event, not what it said.
struct WebhookAttempt {
  enum class Outcome { kDelivered, kWaits, kDead };
  std::string event_id;
  UnixTime at;                           ///< when it was sent
  unsigned attempt = 0;                  ///< 1 = the first for this event since it was queued
  int status = 0;                        ///< HTTP status; 0 = there was no answer
  Duration took{0};
  Outcome outcome = Outcome::kDelivered;
  std::string failure;                   ///< empty = delivered
};

/// The window on a running server's webhooks. Thread: any.
class WebhookControl {
 public:
  virtual ~WebhookControl() = default;
  /// Whether events may be sent there: kOutOfRange or kNotAllowed with the reason.
  virtual Result<void> check_target(const std::string& url) const = 0;
  /// A building's webhooks were changed in the store, or the building is gone: they are read anew.
  virtual void webhooks_changed(BuildingId building) = 0;
  virtual WebhookState state(BuildingId building, std::uint64_t webhook) const = 0;
  virtual std::vector<DeadLetter> dead_letters(BuildingId building, std::uint64_t webhook) const = 0;   ///< oldest first
  /// Queues them anew, or the one of `event`, where not empty; answers how many.
  virtual std::uint64_t retry_dead_letters(BuildingId building, std::uint64_t webhook, const std::string& event) = 0;
  virtual std::vector<WebhookAttempt> attempts(BuildingId building, std::uint64_t webhook) const = 0;   ///< newest first
};

}  // namespace wayfuse
