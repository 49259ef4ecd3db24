#pragma once

#include <functional>

#include "admin/recording_control.hpp"
#include "db/database_directory.hpp"
#include "server/recordings/replay.hpp"
#include "server/sessions/recording_shelf.hpp"

namespace wayfuse {

/// What an operator does with recordings: orders, lists, fetches, erases, and lives through them again.
///
/// A replay reads retired maps on the store's thread and runs on a worker. Thread: any.
class RecordingDesk final : public RecordingControl {
 public:
  using Run = std::function<void(std::function<void()>)>;
  /// Retired maps that a replay makes again, at most; a tape over more of them is replayed on one map.
  static constexpr std::size_t kMapsMade = 8;

  RecordingDesk(RecordingShelf& shelf, DatabaseDirectory& store, const BuildingShelf& buildings, Run run)
      : shelf_(shelf), store_(store), buildings_(buildings), run_(std::move(run)) {}

  Result<RecordingState> order(BuildingId building, const RecordingOrder& order) override;
  Result<RecordingState> state(BuildingId building) const override;
  Result<std::vector<RecordingSummary>> recordings(BuildingId building, std::uint64_t after, std::size_t most) const override;
  Result<RecordingSummary> recording(std::uint64_t id, BuildingId building) const override;
  Result<std::shared_ptr<BodySource>> content(std::uint64_t id, BuildingId building) const override;
  Result<void> erase(std::uint64_t id, BuildingId building) override;
  Result<std::size_t> erase_all(BuildingId building, const std::string& tracked) override;
  void replay(std::uint64_t id, BuildingId building, const ReplayQuestion& question, std::function<void(Result<ReplayAnswer>)> done) override;

 private:
  struct Job;
  Result<void> known(BuildingId building) const;
  void gather(std::shared_ptr<Job> job);
  Result<void> read_maps(Job& job, BuildingDatabase& database) const;
  void play(std::shared_ptr<Job> job);

  RecordingShelf& shelf_;
  DatabaseDirectory& store_;
  const BuildingShelf& buildings_;
  const Run run_;
};

/// A tape as JSON lines, in pieces of a few hundred kilobytes: header, then what the session was fed (sdk/README.md, "Recordings").
std::shared_ptr<BodySource> recording_lines(const RecordingSummary& summary, const std::string& building, TapePieces pieces);

}  // namespace wayfuse
