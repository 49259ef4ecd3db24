#pragma once

#include <memory>
#include <vector>

#include "admin/recording_control.hpp"
#include "server/sessions/session_tape.hpp"

namespace wayfuse {

using TapePieces = std::vector<std::shared_ptr<const TapePiece>>;

/// Everything a tape was tracked with, each map and pipeline once, in order.
std::vector<TrackedWith> tracked_with(const TapePieces& pieces);

/// The snapshots a replay needs. `instead`: all of it on this one, whatever it was.
struct ReplayStage {
  std::vector<std::pair<TrackedWith, std::shared_ptr<const Building>>> buildings;
  std::shared_ptr<const Building> instead;
};

/// Lives through a tape again: the same operations on a timeline of its own. With the recording's pipelines and maps every bit is as it
/// was, and each step says so by itself; with others the walk begins where the tape's tracker stood. `seed`: the session's.
///
/// Cost: the session's own; an explanation for each step of the page.
Result<ReplayAnswer> replay(const TapePieces& pieces, std::uint64_t seed, const ReplayStage& stage, const ReplayQuestion& question);

}  // namespace wayfuse
