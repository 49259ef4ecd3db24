#pragma once

#include <optional>
#include <string>
#include <vector>

#include "wayfuse/proto/fix.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/proto/scan.hpp"

namespace wayfuse {

/// One reading of a session's newest scan, against what the survey holds around the fused place.
struct ReadingExplained {
  Bssid bssid;
  double heard_dbm = 0.0;
  Duration age{0};                     ///< when the scan arrived
  std::string rejected;                ///< why it said nothing about the place; empty = it was used
  std::optional<double> expected_dbm;  ///< mean over the surveyed scans near the fused place that hold it
  int surveyed_scans = 0;              ///< so many
  std::optional<double> residual_db() const { return expected_dbm ? std::optional(heard_dbm - *expected_dbm) : std::nullopt; }
};

/// Why a session's newest position is where it is. Holds access points and particles: for operators only, never for phones.
struct Explanation {
  std::string tracked;
  std::string pipeline;
  FusedPosition position;
  std::vector<ReadingExplained> readings;  ///< largest |residual| first, then those without one; used before rejected
  int surveyed_points = 0;                 ///< near the fused place, on its floor: what the expected levels come from
  std::vector<std::string> doubts;         ///< why integrity is not `ok`
  std::vector<std::string> remarks;        ///< what the pipeline could not prepare here: a corrector without walks to learn from
  struct Particle {
    BuildingPoint point;
    double weight = 0.0;
  };
  std::vector<Particle> particles;         ///< a sample; weights sum to 1; empty where the filter has none
};

/// The window `admin` has on one session's inside; `server` implements it. Thread: any.
class SessionControl {
 public:
  virtual ~SessionControl() = default;
  /// kNotFound: no live session of that public name (in that building, 0 = any). kConflict: it has no position, and why.
  virtual Result<Explanation> explain(const std::string& tracked, BuildingId building) const = 0;
};

}  // namespace wayfuse
