#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>

#include "admin/zone_control.hpp"
#include "db/database_directory.hpp"
#include "server/buildings/building_shelf.hpp"
#include "server/sessions/live_board.hpp"
#include "server/sessions/session_shelf.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

struct SessionSettings {
  Duration hello_deadline = std::chrono::seconds(10);  ///< from the open connection to a valid hello [C6]
  Duration idle_deadline = std::chrono::minutes(10);   ///< without a valid message, except observers [C11]
  Duration keep_alive = std::chrono::seconds(20);      ///< told in welcome: the server pings this often
  Duration sample_ring = std::chrono::seconds(60);     ///< told in welcome: how long to keep what is not acknowledged
  Duration still_interval = std::chrono::seconds(2);   ///< between positions of a phone at rest that has not moved
  Duration least_observation_interval = std::chrono::milliseconds(200);
  std::size_t survey_batches_in_flight = 16;  ///< a connection; more are refused with retry_after
  std::size_t malformed_most = 100;           ///< a connection; then it is closed
};

/// What happened, for the metrics. Counts only grow.
struct SessionCounters {
  using Count = std::atomic<std::uint64_t>;
  Count sessions_begun{0};
  Count sessions_resumed{0};
  Count sessions_not_recovered{0};
  Count samples_applied{0};
  Count samples_duplicate{0};
  Count samples_late_dropped{0};
  Count sequence_gaps{0};
  Count rewinds{0};
  Count positions{0};
  Count no_fixes{0};
  Count unsound_positions{0};  ///< not finite or impossible; withheld. Any is a bug of ours
  Count malformed_messages{0};
  Count survey_batches{0};
  Count survey_points{0};
  Count survey_refused{0};
  Count observations{0};
  Count zone_events{0};  ///< sent to observers
  Count position_age_us{0};  ///< summed over positions: from the evidence to the answer, by the phone's clock offset
  Count apply_us{0};         ///< summed over batches: time spent in trackers
  Count batches{0};
  /// Stated 68 % radii of the positions given: counts up to each bound, beyond the last one, and their sum in mm.
  static constexpr std::array<double, 8> kRadiusBounds_m = {1, 2, 3, 5, 8, 13, 21, 34};
  std::array<Count, kRadiusBounds_m.size() + 1> radius_counts{};
  Count radius_sum_mm{0};
  void note_radius(double radius_m) {
    const auto bound = std::ranges::lower_bound(kRadiusBounds_m, radius_m);
    radius_counts[static_cast<std::size_t>(bound - kRadiusBounds_m.begin())]++;
    radius_sum_mm += static_cast<std::uint64_t>(radius_m * 1000.0);
  }
};

/// All that conversations need from outside. Thread: what it refers to is safe from any strand.
struct SessionWorld {
  const Clock& clock;
  const BuildingShelf& buildings;
  SessionShelf& sessions;
  LiveBoard& board;
  DatabaseDirectory& store;
  SessionCounters& counters;
  std::function<void(BuildingId)> survey_changed;  ///< a survey batch was committed; any thread
  SessionSettings settings;
  ZoneControl* zones = nullptr;  ///< null = nobody watches zones here, and who asks for their events is told so
  /// What a placed phone heard, now and then: for the health of access points. May be empty; any thread.
  std::function<void(std::uint64_t session, const Building& building, const RssScan& scan, const FusedPosition& position)> heard = {};
  RecordingShelf* recordings = nullptr;  ///< null = nothing is ever recorded
  /// Has a pipeline that is not at hand made ready, elsewhere: sessions hold their samples meanwhile. Empty: sessions make it themselves.
  std::function<void(std::shared_ptr<const Building> building, const std::string& pipeline)> prepare = {};
};

}  // namespace wayfuse
