#pragma once

#include "server/locating/survey_gate.hpp"

namespace wayfuse {

/// A survey point that was kept out of the radio map, with what an operator needs to find it and judge for himself.
struct DoubtfulPoint {
  SurveyDoubt doubt;
  Place stated;
  std::string walk;                ///< empty = a standing point
  std::string device_model;
  UnixTime surveyed_at;
};

}  // namespace wayfuse
