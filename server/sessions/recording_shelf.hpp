#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "admin/recording_control.hpp"
#include "server/sessions/session_tape.hpp"

namespace wayfuse {

/// A session on tape, with its name.
struct RecordedSession {
  std::uint64_t id = 0;
  BuildingId building;
  std::string tracked, device_model, app;
  std::uint64_t seed = 0;
  SessionTape tape;
  std::atomic<bool> stopped{false};  ///< erased, or the order ended: nothing more is written
};

/// What operators ordered to be recorded, and the tapes. In memory only: a restart forgets them [SAFETY C19].
///
/// Every building has its own bounds: bytes, age, and so many sessions at once that each has room for a piece. Where there is no room the
/// oldest piece of any session goes. Pieces hold copies of trackers, and those the map they were made over: no more than kMapsMost maps
/// of a building are held so. Thread: any; one mutex, taken after a session's own, never held while calling out.
class RecordingShelf {
 public:
  static constexpr std::size_t kMapsMost = 4;
  static constexpr std::size_t kSessionBytes = 1u << 20;        ///< of the order's bytes, for a session to be taken in
  static constexpr std::size_t kBytesMost = 512u << 20;         ///< ordered over all buildings

  RecordingShelf(const Clock& clock, std::uint64_t epoch) : clock_(clock), epoch_(epoch) {}

  Result<RecordingState> order(BuildingId building, const RecordingOrder& order);
  RecordingState state(BuildingId building) const;
  std::vector<RecordingSummary> list(BuildingId building, std::uint64_t after, std::size_t most) const;
  /// Null where there is none in that building; 0 = any.
  std::shared_ptr<const RecordedSession> find(std::uint64_t id, BuildingId building) const;
  std::optional<RecordingSummary> summary(std::uint64_t id, BuildingId building) const;
  bool erase(std::uint64_t id, BuildingId building);
  std::size_t erase_all(BuildingId building, const std::string& tracked);
  /// Forgets what is too old, and stops what was ordered long enough; about once a second.
  void sweep();

  /// Whether anything is recorded anywhere: all a session asks when nothing is.
  bool idle() const { return !active_.load(std::memory_order_relaxed); }
  /// What a session in that building writes on from here: `present` again, a new one, or null.
  std::shared_ptr<RecordedSession> tape_for(std::shared_ptr<RecordedSession> present, BuildingId building, const std::string& tracked,
                                            const std::string& device_model, const std::string& app, std::uint64_t seed);
  /// Whether tape_for() would give one; changes nothing.
  bool records(const RecordedSession* present, BuildingId building, const std::string& tracked) const;
  /// `session` was written to, so many bytes: what has no room any more goes.
  void grown(const RecordedSession& session, std::size_t bytes, bool new_piece);
  /// The building as it is described; the same object as long as nothing a tracker sees changes.
  std::shared_ptr<const BuildingRecord> description_of(const Building& building);
  UnixTime now() const { return clock_.wall_now(); }

 private:
  struct Shelf {
    RecordingOrder order;
    std::optional<ServerTime> until;
    std::optional<UnixTime> until_wall;
    std::shared_ptr<const BuildingRecord> description;
    std::vector<std::string> erased;    // phones not to be recorded under this order any more
    std::uint64_t pieces_dropped = 0;
    std::set<std::string> not_recorded;  // under this order, for want of room
    std::int64_t used = 0;
    std::size_t writing = 0;            // sessions, as of the newest sweep and those begun since
  };
  using Sessions = std::map<std::uint64_t, std::shared_ptr<RecordedSession>>;
  void make_room(BuildingId building, Shelf& shelf);
  bool drop_oldest(BuildingId building, Shelf& shelf);
  void forget(RecordedSession& session);
  std::size_t maps_held(BuildingId building) const;
  bool on(const Shelf& shelf) const { return shelf.until && clock_.now() < *shelf.until; }
  bool wants(BuildingId building, const std::string& tracked) const;
  void note_activity();
  RecordingState state_of(BuildingId building) const;
  RecordingSummary summary_of(const std::shared_ptr<RecordedSession>& session) const;

  const Clock& clock_;
  const std::uint64_t epoch_;
  std::atomic<bool> active_{false};
  mutable std::mutex mutex_;
  std::map<BuildingId, Shelf> shelves_;
  Sessions sessions_;
  std::uint64_t newest_id_ = 0;
};

}  // namespace wayfuse
