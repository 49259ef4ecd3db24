#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "server/buildings/building_keeper.hpp"
#include "server/net/outbox.hpp"
#include "server/sessions/session.hpp"
#include "server/sessions/session_world.hpp"
#include "tests/fixtures/virtual_scheduler.hpp"

namespace wayfuse {

/// The server's clocks in virtual time.
class SimulatedClock final : public Clock {
 public:
  explicit SimulatedClock(const VirtualScheduler& scheduler) : scheduler_(scheduler) {}
  ServerTime now() const override { return ServerTime(scheduler_.now().time_since_epoch()); }
  UnixTime wall_now() const override { return UnixTime(scheduler_.now().time_since_epoch() + std::chrono::hours(400'000)); }

 private:
  const VirtualScheduler& scheduler_;
};

/// How a session was begun, for whoever wants to recompute it.
struct BegunSession {
  std::string name;
  std::uint64_t seed = 0;
};

/// A whole server without sockets and threads over one data folder: sessions, buildings and the real store. A crash is its
/// destruction; what the store had committed is there for the next one.
class SimulatedServer {
 public:
  SimulatedServer(const VirtualScheduler& scheduler, const std::filesystem::path& folder, std::uint64_t seed);
  ~SimulatedServer();

  /// Makes a building of that survey and answers its id.
  BuildingId add_building(const std::string& name, const std::string& pipeline, const std::vector<ReferencePoint>& survey);

  SessionWorld& world() { return *world_; }
  DatabaseDirectory& store() { return *store_; }
  const BuildingShelf& buildings() const { return buildings_; }
  const std::vector<BegunSession>& begun() const { return begun_; }
  const SessionCounters& counters() const { return counters_; }
  /// What the world's timers do once a second.
  void sweep();

 private:
  SimulatedClock clock_;
  Random random_;
  std::vector<BegunSession> begun_;
  std::unique_ptr<DatabaseDirectory> store_;
  BuildingShelf buildings_;
  std::unique_ptr<BuildingKeeper> keeper_;
  SessionShelf sessions_;
  LiveBoard board_;
  SessionCounters counters_;
  std::unique_ptr<SessionWorld> world_;
};

}  // namespace wayfuse
