#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "server/buildings/building_shelf.hpp"
#include "server/buildings/device_offsets.hpp"
#include "tests/evaluation/walks/replay.hpp"
#include "tests/evaluation/walks/selection.hpp"

namespace wayfuse {

/// A whole server without sockets, on a temporary folder: its building is created, then surveyed through surveyor, client,
/// codec, session and store; walks go through motion tracker, client, codec and session. Everything on virtual clocks.
class SessionReplay final : public WalkReplay {
 public:
  struct Survey {
    std::function<void(std::vector<SurveyBatch>&)> spoil;  ///< what happens to batches before they go up; empty: nothing
    bool gate = true;                                      ///< of the server, before its radio map
  };
  /// Uploads the survey and waits for the snapshot. Throws std::runtime_error if the store fails.
  static Result<std::unique_ptr<SessionReplay>> create(const RecordedSite& site, const std::vector<RecordedWalk>& survey,
                                                       const Survey& how = {{}, true});
  ~SessionReplay() override;

  /// What the server made of the survey; shared with DirectReplay.
  std::shared_ptr<const Site> site() const;
  /// What the server's gate left out of its map.
  std::span<const DoubtfulPoint> doubts() const;
  /// What the server's map in force says of the phones that surveyed.
  std::vector<DeviceLevel> devices() const;
  /// Prepares a pipeline before the threads begin: kUnknownName lists those there are.
  Result<void> prepare(const std::string& pipeline);
  std::string_view path() const override { return "session"; }
  Result<WalkReply> run(const RecordedWalk& walk, std::span<const Instant> instants, const std::string& pipeline,
                        std::uint64_t seed) const override;

 private:
  struct House;
  explicit SessionReplay(std::unique_ptr<House> house);
  std::unique_ptr<House> house_;
};

}  // namespace wayfuse
