#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/sessions/tracking_session.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

struct SessionShelfSettings {
  Duration resumable = std::chrono::minutes(5);  ///< how long a session outlives its connection
  std::size_t most = 20000;                      ///< sessions, connected or not
};

/// What is random about a new session. The world draws it from the system's generator, a simulation from its seed.
struct SessionNames {
  std::function<std::string()> secret;   ///< at least 128 bits, unguessable: whoever knows it may resume
  std::function<std::string()> tracked;  ///< the public name
  std::function<std::uint64_t()> seed;   ///< of the session's generator
};

/// Every tracking session of this server, connected or waiting to be resumed. They live in memory only: a restart begins a
/// new epoch and clients are told `recovered: false` [SAFETY C17].
///
/// Thread: any; one mutex, never held while calling out.
class SessionShelf {
 public:
  SessionShelf(std::uint64_t epoch, SessionNames names, SessionShelfSettings settings);

  std::uint64_t epoch() const { return epoch_; }
  /// Null when the shelf is full of connected sessions; otherwise the longest disconnected one makes room.
  std::shared_ptr<TrackingSession> begin(SessionRequest request, const BuildingShelf& buildings, ServerTime now);
  /// Null if there is none of that name, or it began under another key.
  std::shared_ptr<TrackingSession> find(const std::string& name, std::uint64_t key_id) const;
  /// By its public name, which resumes nothing; for the operator.
  std::shared_ptr<TrackingSession> find_tracked(const std::string& tracked) const;
  void end(const std::string& name);
  /// Public names of sessions that expired; they are forgotten.
  std::vector<std::string> sweep(ServerTime now);
  std::size_t size() const;

 private:
  const std::uint64_t epoch_;
  const SessionNames names_;
  const SessionShelfSettings settings_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<TrackingSession>> sessions_;
  std::vector<std::string> evicted_;  ///< public names, told by the next sweep
};

}  // namespace wayfuse
