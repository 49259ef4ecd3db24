#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "admin/access.hpp"
#include "admin/audit_trail.hpp"
#include "admin/idempotency.hpp"
#include "admin/router.hpp"
#include "admin/server_control.hpp"
#include "admin/session_control.hpp"
#include "db/database_directory.hpp"
#include "server/buildings/building_keeper.hpp"
#include "server/config.hpp"
#include "server/log.hpp"
#include "server/maps/map_desk.hpp"
#include "server/net/listener.hpp"
#include "server/recordings/recording_desk.hpp"
#include "server/webhooks/webhook_sender.hpp"
#include "server/zones/zone_watch.hpp"
#include "server/system_clock.hpp"
#include "server/worker_pool.hpp"

namespace wayfuse {

/// Brings every position to the zones.
class ZoneFeed final : public PositionWatcher {
 public:
  explicit ZoneFeed(ZoneWatch& zones) : zones_(zones) {}
  void moved(const std::string& tracked, const FusedPosition& position) override { zones_.moved(tracked, position); }
  void gone(const std::string& tracked) override { zones_.gone(tracked); }

 private:
  ZoneWatch& zones_;
};

/// The whole server, put together: the only place that knows every room.
///
/// Thread: start(), reload() and drain() belong to one thread; what ServerControl and SessionControl offer is safe from any.
class App final : public ServerControl, public SessionControl {
 public:
  /// Opens the store, makes every building ready, listens. Afterwards it serves.
  static Result<std::unique_ptr<App>> start(ServerConfig config);
  ~App() override;

  std::uint16_t port() const { return listener_->port(); }
  std::string url() const;
  /// The admin key made on the first start; empty otherwise, or when it went to a file.
  const std::string& first_key() const { return first_key_; }

  /// SIGHUP: reads certificate and key again and takes the keys of `wanted` that reload; names those that wait for a restart.
  void reload(const ServerConfig& wanted);
  /// SIGHUP with a configuration that does not serve: said in the log, nothing changes.
  void refuse_reload(const Fault& fault);
  /// SIGTERM: not ready, nobody new, everybody told, everything stored [SAFETY C20].
  void drain();

  // ---- ServerControl
  Readiness readiness() const override;
  std::vector<SessionSummary> sessions(BuildingId building) const override;
  std::string metrics() const override;
  std::vector<PartDescription> parts() const override;
  std::vector<std::string> presets() const override;
  Result<std::string> preset_json(const std::string& name) const override;
  void building_changed(BuildingId building) override;
  void building_made(BuildingId building, std::function<void()> served) override;
  std::uint64_t radio_map_version(BuildingId building) const override;

  // ---- SessionControl
  Result<Explanation> explain(const std::string& tracked, BuildingId building) const override;

 private:
  App(ServerConfig config, std::unique_ptr<DatabaseDirectory> store);
  Result<void> open();
  Result<void> make_first_key();
  void sweep();
  void forget();
  BuildingKeeper::Settings keeper_settings();

  const ServerConfig config_;
  SystemClock clock_;
  Log log_;
  std::unique_ptr<DatabaseDirectory> store_;
  std::unique_ptr<KeyRing> keys_;
  std::unique_ptr<AuditTrail> audit_;
  IdempotencyLedger ledger_{*store_, clock_};
  std::string first_key_;
  WorkerPool workers_;
  BuildingShelf shelf_;
  BuildingKeeper keeper_;
  AccessPointDesk access_points_;
  MapDesk maps_;
  SessionShelf sessions_;
  RecordingShelf recordings_{clock_, sessions_.epoch()};
  RecordingDesk recording_desk_{recordings_, *store_, shelf_, [this](std::function<void()> task) { workers_.run(std::move(task)); }};
  ZoneWatch zones_;
  ZoneFeed zone_feed_{zones_};
  WebhookSender webhooks_;
  LiveBoard board_{&zone_feed_};
  SessionCounters session_counters_;
  SessionWorld session_world_;
  NetCounters net_counters_;
  std::unique_ptr<Router> router_;
  std::unique_ptr<NetWorld> net_world_;
  std::unique_ptr<Listener> listener_;
  std::atomic<bool> ready_{false};
  bool drained_ = false;
  int sweeps_ = 0;
};

}  // namespace wayfuse
