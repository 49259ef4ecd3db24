#pragma once

#include <vector>

#include "sdk/src/simulator/propagation.hpp"
#include "sdk/src/simulator/sensors.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse::simulator {

struct SurveyingSettings {
  int passes = 2;                     ///< over every room of a floor, 1..20
  double mark_every_s = 2.0;          ///< how often the surveyor says where they are
  double mark_sigma_m = 0.3;          ///< how well they know it
  UnixTime at;                        ///< wall-clock time of the survey
};

/// Walks every room of one floor and returns what the surveyor would upload.
std::vector<SurveyBatch> survey_floor(const World& world, const Propagation& propagation, FloorOrdinal floor, const Device& device,
                                      const SurveyingSettings& settings, Random random);

}  // namespace wayfuse::simulator
