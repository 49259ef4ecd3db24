#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "server/locating/survey_fingerprints.hpp"

namespace wayfuse {

/// A survey point that the rest of the survey contradicts.
struct SurveyDoubt {
  enum class Cause : std::uint8_t {
    kRadio,                        ///< what was heard there is heard elsewhere, and not around the stated place
    kWalk,                         ///< so for most of its walk: the whole walk is out of place
    kPace,                         ///< nobody could have walked there and back in the time
  };
  std::size_t point = 0;           ///< index into the survey
  Cause cause = Cause::kRadio;
  Place heard_at;                  ///< where others heard the like; kPace: half-way between its neighbours in time
  double off_m = 0.0;              ///< from the stated place to there; infinite on another floor
  double excess = 0.0;             ///< how much worse it fits around its stated place than there, in Sorensen distance; 0 for kPace
  bool operator==(const SurveyDoubt&) const = default;
};
std::string to_string(SurveyDoubt::Cause cause);
/// One line for an operator: `point 17: heard like 42 m away on this floor (..)`. Names no address.
std::string to_string(const SurveyDoubt& doubt);

struct SurveyGateSettings {
  ReadingStrength strength;
  double near_m = 12.0;            ///< whoever was this near to the stated place must have heard the like
  double far_m = 18.0;             ///< nearer than this a misplaced point does no harm worth a doubt
  double margin = 0.16;            ///< of Sorensen distance by which elsewhere must fit better
  double walk_margin = 0.10;       ///< the same for the median over a walk: many points need less each
  double twin = 0.30;              ///< a distance as small as this is the same place; where nobody else was near only a twin counts
  double alike = 0.9;              ///< elsewhere must fit as well as this share of the survey fits around its own places
  double fastest_mps = 6.0;        ///< over ground, there and away again
};

/// The gate before a radio map: every point, and every walk, against all *other* walks and standing points.
///
/// Two rules, neither of which knows the building. A point is doubtful where the best of its neighbours in space fits by
/// `margin` worse than places at least `far_m` off that two other walks agree on; a walk where that is so in the median.
/// Elsewhere must fit as well as points usually fit around their own places: one that fits nowhere was surveyed by nobody else.
/// Where nobody else surveyed nearby only a near twin elsewhere casts doubt. Doubtful points bear no witness against others.
/// Deterministic, points in any order. Cost: a sparse match of every point against all others.
std::vector<SurveyDoubt> doubtful_points(std::span<const ReferencePoint> survey, const SurveyGateSettings& settings = {});

}  // namespace wayfuse
