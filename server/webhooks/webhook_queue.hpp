#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "admin/webhook_control.hpp"
#include "admin/zone_control.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

struct WebhookSettings {
  bool private_targets = false;                      ///< loopback and private networks too, and plain HTTP
  unsigned attempts = 12;                            ///< then an event is a dead letter: with the waits below, after some 20 minutes
  Duration first_wait = std::chrono::seconds(1);     ///< doubled at each failure, times 0.5..1 at random
  Duration longest_wait = std::chrono::minutes(5);
  std::size_t waiting_most = 1000;                   ///< events of one webhook; the oldest becomes a dead letter
  std::size_t dead_most = 1000;                      ///< dead letters of one webhook; the oldest is dropped
  std::size_t attempts_most = 200;                   ///< newest attempts of one webhook that are told of
};

/// One event for one webhook.
struct WebhookDelivery {
  BuildingId building;
  std::uint64_t webhook = 0;
  std::string url;
  std::string secret;
  std::string id;                                    ///< of the event
  UnixTime at;                                       ///< of the event
  std::string body;
  unsigned attempts = 0;                             ///< made so far
  ServerTime due;
  UnixTime sent_at;                                  ///< of the attempt under way
  Duration took{0};                                  ///< it took, once it is over
  int status = 0;                                    ///< it was answered; 0 = it was not
};

/// What waits to be delivered, and when it is tried again. Bounded, in memory only.
///
/// One event of a webhook is under way at a time; one that failed waits its time while the others go on, so that a receiver
/// may see events out of order and tells by their time and id. Thread: confined to the sender (its mutex).
class WebhookQueue {
 public:
  WebhookQueue(WebhookSettings settings, Random random) : settings_(settings), random_(random) {}

  /// A building's webhooks as they are now; what waits for one that is no more is forgotten.
  void put_webhooks(BuildingId building, const std::vector<WebhookRecord>& webhooks);
  void offer(const NumberedZoneEvent& event, ServerTime now);
  /// The next event whose time has come; it counts as under way until done() or failed().
  std::optional<WebhookDelivery> take(ServerTime now);
  void done(const WebhookDelivery& delivery);
  /// `final`: no further attempt makes sense.
  void failed(WebhookDelivery delivery, std::string failure, bool final, ServerTime now);
  /// When take() may have something again; absent = not before something is offered.
  std::optional<ServerTime> next_due() const;

  WebhookState state(BuildingId building, std::uint64_t webhook) const;
  std::vector<DeadLetter> dead_letters(BuildingId building, std::uint64_t webhook) const;
  /// All of them, or the one of `event` where it is not empty.
  std::uint64_t retry_dead_letters(BuildingId building, std::uint64_t webhook, const std::string& event, ServerTime now);
  std::vector<WebhookAttempt> attempts(BuildingId building, std::uint64_t webhook) const;
  WebhookState total() const;

 private:
  struct Dead {
    WebhookDelivery delivery;
    std::string failure;
  };
  struct Lane {
    WebhookRecord record;
    std::deque<WebhookDelivery> waiting;
    bool under_way = false;
    std::deque<Dead> dead;
    std::deque<WebhookAttempt> attempts;  // oldest first
    WebhookState counts;
  };
  using Key = std::pair<BuildingId, std::uint64_t>;
  void note(Lane& lane, const WebhookDelivery& delivery, WebhookAttempt::Outcome outcome, const std::string& failure) const;
  void bury(Lane& lane, WebhookDelivery delivery, std::string failure);
  void make_room(Lane& lane);
  static WebhookState state_of(const Lane& lane);
  const Lane* lane(BuildingId building, std::uint64_t webhook) const;

  const WebhookSettings settings_;
  Random random_;
  std::map<Key, Lane> lanes_;
};

}  // namespace wayfuse
