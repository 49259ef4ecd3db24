#pragma once

#include <span>
#include <vector>

#include "server/locating/radio_field.hpp"

namespace wayfuse {

/// How well a field tells where the survey's own scans were, each matched without its own walk.
struct SurveyFit {
  std::vector<double> log_likelihood;  ///< a survey walk or standing point by its number: sum over its scans
  std::vector<int> scans;              ///< asked of it

  double total() const;
};

struct Learnt {
  FieldWeights weights;
  SurveyFit fit;                       ///< with these weights
};

/// Weights of the two fields by conditional logit: of all surveyed nodes of the floor, the one where the survey's scan really
/// was shall be the likeliest, the scan's own walk left out of the field. A Gaussian prior about FieldWeights{} settles what
/// the survey leaves open: the split between the two is weakly identified.
///
/// Deterministic. Cost: bounded by `most_queries`, whatever the survey's size; they are spread over all walks.
Learnt learn_weights(const RadioField& field, std::size_t most_queries = 400);

/// How far each survey walk, by its number, is to be moved towards where the others hear it, in metres. Ways are marked by hand and
/// walked by a body and a clock: what a walk is off by as a whole is known from nobody but the other walks.
///
/// Half of its scans' mean error, each scan matched without its own walk and against ground nearby only: the others come the other
/// half of the way. Few scans say little, and their mean is drawn to nothing; a single one, or a standing point, stays.
std::vector<BuildingPoint> shifts_of_walks(const RadioField& field);

/// Whether `challenger` tells more than chance would: its lead is twice its standard error over walks, whose scans err together.
bool clearly_better(const SurveyFit& challenger, const SurveyFit& standard);

/// The top of a parabola through the best of the fits and its neighbours, drawn to a prior (1.5 s, give or take 1 s) by its own
/// uncertainty: a stamp is made when a frame is heard (0 s), and phones turned out to be 1 to 3 s off. The uncertainty is what
/// leaving out an eighth of the walks at a time changes [Quenouille's jackknife]. A survey of standing points fits every delay alike
/// and gets the prior's mean. At least three delays, evenly spaced, ascending.
double likeliest_delay_s(std::span<const double> delays_s, std::span<const SurveyFit> fits);

}  // namespace wayfuse
