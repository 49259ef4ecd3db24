#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>

#include "admin/webhook_control.hpp"
#include "admin/zone_control.hpp"
#include "db/database_directory.hpp"
#include "server/webhooks/webhook_queue.hpp"

namespace wayfuse {

/// Posts zone events to the webhooks that want them, on one thread of its own through libcurl's multi interface.
///
/// HTTPS is verified against the system's authorities, redirects are not followed, proxies of the environment are not used,
/// and an address that is not public is refused at the moment of connecting, so that no name can lead inside (see
/// target_guard.hpp). An attempt takes at most 10 s; of an answer only the status counts.
///
/// Thread: any; one mutex over the queue, not held while calling out.
class WebhookSender final : public WebhookControl {
 public:
  WebhookSender(DatabaseDirectory& store, ZoneControl& zones, const Clock& clock, WebhookSettings settings, std::uint64_t seed);
  ~WebhookSender() override;

  void start();
  /// Stops at once; what waits is lost with the process.
  void stop();
  /// Instead of reading the store.
  void put_webhooks(BuildingId building, const std::vector<WebhookRecord>& webhooks);
  WebhookState total() const;

  // ---- WebhookControl
  Result<void> check_target(const std::string& url) const override;
  void webhooks_changed(BuildingId building) override;
  WebhookState state(BuildingId building, std::uint64_t webhook) const override;
  std::vector<DeadLetter> dead_letters(BuildingId building, std::uint64_t webhook) const override;
  std::uint64_t retry_dead_letters(BuildingId building, std::uint64_t webhook, const std::string& event) override;
  std::vector<WebhookAttempt> attempts(BuildingId building, std::uint64_t webhook) const override;

 private:
  class Transfers;
  void work();
  void take_events();
  void wake();

  DatabaseDirectory& store_;
  ZoneControl& zones_;
  const Clock& clock_;
  const WebhookSettings settings_;
  mutable std::mutex mutex_;
  WebhookQueue queue_;
  std::uint64_t taken_through_ = 0;      ///< of the sender's thread
  std::shared_ptr<void> listening_;
  std::unique_ptr<Transfers> transfers_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace wayfuse
