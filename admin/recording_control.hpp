#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "admin/http.hpp"
#include "admin/session_control.hpp"

namespace wayfuse {

/// What an operator orders for a building: what phones send there is written down for so long, in memory only.
struct RecordingOrder {
  static constexpr std::size_t kLeastBytes = 1u << 20;
  static constexpr std::size_t kMostBytes = 256u << 20;
  Duration on_for{0};                  ///< 0 = off from now on; what is there stays until it is too old
  std::size_t bytes = 64u << 20;       ///< of all the building's recordings; the oldest pieces go first
  Duration kept = std::chrono::hours(24);
  std::vector<std::string> tracked;    ///< only these phones; empty = every phone
};

/// The order in force, and what came of it.
struct RecordingState {
  std::optional<UnixTime> until;       ///< absent: off
  std::size_t bytes = 0;
  Duration kept{0};
  std::vector<std::string> tracked;
  std::size_t bytes_used = 0;          ///< about
  std::size_t recordings = 0;
  std::uint64_t pieces_dropped = 0;    ///< to make room, since the server started
  std::uint64_t not_recorded = 0;      ///< sessions for which there was no room
};

/// One session as it was recorded: what its tracker was fed, in the order in which it was applied.
struct RecordingSummary {
  std::uint64_t id = 0;
  BuildingId building;
  std::string tracked;
  std::string device_model;
  std::string app;
  std::string pipeline;                ///< in force when it ended
  std::uint64_t first_map = 0, last_map = 0;
  std::uint64_t seed = 0;              ///< of the session's generator
  std::uint64_t epoch = 0;             ///< of the server
  UnixTime begun_at, ended_at;         ///< of what is there
  bool growing = false;                ///< the session lives, and is still recorded
  bool from_the_start = false;         ///< its first sample is the session's first; otherwise it begins with a copy of the tracker as it was
  std::uint64_t pieces_dropped = 0;    ///< older ones, for want of room or by their age
  std::uint64_t samples = 0;
  std::uint64_t answers = 0;           ///< moments at which a position was asked for
  std::size_t bytes = 0;
};

/// How a recording is to be lived through again.
struct ReplayQuestion {
  std::string pipeline;                       ///< empty = as it was
  std::optional<std::uint64_t> map_version;   ///< absent = as it was
  std::uint64_t after = 0;                    ///< steps up to this number are not answered
  std::size_t most = 20;                      ///< steps, 1..200
  std::size_t particles = 100;                ///< shown a step, 0..500
};

/// One moment of a replay: after a batch of samples.
struct ReplayStep {
  std::uint64_t number = 0;                   ///< 1, 2, 3, ..
  PhoneTime at;                               ///< of the newest evidence
  std::uint64_t applied_through = 0;          ///< number of the newest sample
  std::uint64_t map_version = 0;
  bool said = false;                          ///< the phone was told a position then
  std::optional<bool> as_live;                ///< the same bits; absent: none was told, or this is another pipeline or map
  std::optional<Fault> no_position;           ///< why there is none
  std::optional<Explanation> explanation;     ///< with the position
};

struct ReplayAnswer {
  std::string pipeline;                       ///< as asked, else as it was at the end
  bool as_it_was = true;                      ///< the recording's own pipelines and maps
  std::uint64_t steps = 0;                    ///< in all
  std::uint64_t differing = 0;                ///< steps that were told and came out otherwise; 0 unless as_it_was
  std::vector<ReplayStep> page;
  std::vector<std::string> remarks;           ///< what was lost or cannot be as it was
};

/// The window `admin` has on recordings; `server` implements it. A building of 0 stands for all; what lies in another one is kNotFound.
///
/// Thread: any.
class RecordingControl {
 public:
  virtual ~RecordingControl() = default;
  virtual Result<RecordingState> order(BuildingId building, const RecordingOrder& order) = 0;
  virtual Result<RecordingState> state(BuildingId building) const = 0;
  /// Ascending by id, those after `after`.
  virtual Result<std::vector<RecordingSummary>> recordings(BuildingId building, std::uint64_t after, std::size_t most) const = 0;
  virtual Result<RecordingSummary> recording(std::uint64_t id, BuildingId building) const = 0;
  /// JSON lines (sdk/README.md, "Recordings").
  virtual Result<std::shared_ptr<BodySource>> content(std::uint64_t id, BuildingId building) const = 0;
  /// For good. A session that lives is not recorded any more until the next order.
  virtual Result<void> erase(std::uint64_t id, BuildingId building) = 0;
  /// Those of one phone; empty = all of the building. How many there were.
  virtual Result<std::size_t> erase_all(BuildingId building, const std::string& tracked) = 0;
  virtual void replay(std::uint64_t id, BuildingId building, const ReplayQuestion& question, std::function<void(Result<ReplayAnswer>)> done) = 0;
};

}  // namespace wayfuse
