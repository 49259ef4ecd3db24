#pragma once

#include <string>
#include <vector>

#include "wayfuse/sdk/recording.hpp"

namespace wayfuse {

/// What recordings of walks look like in numbers: the same for real and simulated ones.
struct WalkStatistics {
  std::size_t walks = 0;
  std::size_t scans = 0;
  double age_median_s = 0.0;         ///< of all rows of all lists
  double age_p90_s = 0.0;
  double repeated_share = 0.0;       ///< of a list's rows that an earlier list told already; mean over lists but the first
  double same_stamp_share = 0.0;     ///< ... with the same stamp to the bit: phones' stamps of one reading differ by a millisecond
  double interval_median_s = 0.0;    ///< between lists
  double rss_p5_dbm = 0.0, rss_median_dbm = 0.0, rss_p95_dbm = 0.0;
  double jump_median_db = 0.0, jump_p90_db = 0.0;   ///< between two readings of one transmitter that follow each other
  double cadence_median_hz = 0.0;    ///< while walking, as MotionTracker sees it
  double direction_median_deg = 0.0; ///< reported steps against way points 8 m apart or more, a walk's constant offset removed
  std::size_t legs = 0;              ///< so many such stretches
};
WalkStatistics statistics_of(const std::vector<std::vector<RecordedEvent>>& walks);
/// One line a figure.
std::string to_string(const WalkStatistics& statistics);

}  // namespace wayfuse
