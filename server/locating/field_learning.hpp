#pragma once

#include "server/locating/radio_field.hpp"

namespace wayfuse {

/// Weights of the two fields by conditional logit: of all surveyed nodes of the floor, the one where the survey's scan really
/// was shall be the likeliest, the scan's own walk left out of the field. A Gaussian prior about FieldWeights{} settles what
/// the survey leaves open: the split between the two is weakly identified.
///
/// Deterministic. Cost: bounded by `most_queries`, whatever the survey's size.
FieldWeights learn_weights(const RadioField& field, std::size_t most_queries = 400);

}  // namespace wayfuse
