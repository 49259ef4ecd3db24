#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/pipeline/tracker.hpp"
#include "server/quality/walk_quality.hpp"

namespace wayfuse {

/// One survey walk, or one standing point, as a phone on it would have reported: its scans, and steps along its path with a
/// phone's usual errors (compass 8 degrees, stride 4 %).
struct SurveyedTrack {
  std::string name;                      ///< of the walk; empty = a standing point
  std::vector<std::size_t> points;       ///< indices into the survey
  RecordedTrack track;
  std::vector<PhoneTime> ask_at;         ///< where the truth is known: at the points' own scans
};

/// Takes a survey apart into such tracks. Deterministic: the errors follow from the walk's place in the survey.
std::vector<SurveyedTrack> tracks_of_survey(const Site& site);

}  // namespace wayfuse
