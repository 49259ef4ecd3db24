#pragma once

#include <span>

#include "server/locating/radio_field.hpp"

namespace wayfuse {

/// Weights of the two fields by conditional logit: of all surveyed nodes of the floor, the one where the survey's scan really
/// was shall be the likeliest, the scan's own walk left out of the field. A Gaussian prior about FieldWeights{} settles what
/// the survey leaves open: the split between the two is weakly identified.
///
/// Deterministic. Cost: bounded by `most_queries`, whatever the survey's size.
FieldWeights learn_weights(const RadioField& field, std::size_t most_queries = 400);

/// Log-likelihood of where the survey's own scans were, each counted as a fifth of a scan: those of one walk err together.
double log_fit(const RadioField& field, std::size_t most_queries = 200);

/// The top of a parabola through the best of the fits and its neighbours, under a Gaussian prior: a stamp is made when a frame
/// is heard (0 s), and phones turned out to be 1 to 3 s off. Of walks in both directions; a survey of standing points fits
/// every delay alike and gets the prior's mean.
double likeliest_delay_s(std::span<const double> delays_s, std::span<const double> fits);

}  // namespace wayfuse
