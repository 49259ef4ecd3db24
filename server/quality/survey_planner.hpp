#pragma once

#include "server/quality/accuracy_model.hpp"

namespace wayfuse {

/// What to walk next on a floor: up to five walks over unsurveyed ground where phones can be, each the one that takes most off
/// the expected error a metre walked, the walks before it counted as done. Nothing where nothing is worth it.
///
/// Paths follow the walkable area cell by cell and are at most 60 m long. Deterministic.
Result<SurveyPlan> plan_survey(const AccuracyModel& model, FloorOrdinal floor);

}  // namespace wayfuse
