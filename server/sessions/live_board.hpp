#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "admin/server_control.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// Who wants to know of every position, besides those who ask the board. Called on any strand, outside the board's mutex.
class PositionWatcher {
 public:
  virtual ~PositionWatcher() = default;
  virtual void moved(const std::string& tracked, const FusedPosition& position) = 0;
  virtual void gone(const std::string& tracked) = 0;
};

/// Where every tracked phone is now: what observers and the operator see. Names are public ones and resume nothing.
///
/// Only the newest position is kept, and only in memory [SAFETY C19]. Thread: any; one mutex, never held while calling out.
class LiveBoard {
 public:
  explicit LiveBoard(PositionWatcher* watcher = nullptr) : watcher_(watcher) {}

  /// A session began, was resumed, or lost its connection.
  void put(const SessionSummary& summary);
  void moved(const std::string& tracked, const FusedPosition& position, std::uint64_t applied_through, UnixTime at);
  void set_connected(const std::string& tracked, bool connected);
  /// The session ended: observers are told once, then it is forgotten by sweep().
  void gone(const std::string& tracked, UnixTime at);
  /// Forgets sessions that went before `before`.
  void sweep(UnixTime before);

  struct Changes {
    std::vector<Observed> observed;  ///< oldest change first
    std::uint64_t through = 0;       ///< ask for what came after this next time
  };
  /// What changed after revision `after`, at most `most` phones; building 0 = all.
  Changes changes_after(std::uint64_t after, BuildingId building, std::size_t most) const;
  /// Ascending by name, without those that are gone; building 0 = all.
  std::vector<SessionSummary> sessions(BuildingId building) const;
  std::size_t size() const;

 private:
  struct Entry {
    SessionSummary summary;
    UnixTime received_at;
    std::optional<UnixTime> gone_at;
    std::uint64_t revision = 0;
  };
  void touch(Entry& entry);

  PositionWatcher* const watcher_;
  mutable std::mutex mutex_;
  std::map<std::string, Entry> entries_;
  std::map<std::uint64_t, Entry*> by_revision_;  ///< only entries with a position
  std::uint64_t revision_ = 0;
};

}  // namespace wayfuse
