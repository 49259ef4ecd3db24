#pragma once

#include <vector>

#include "server/locating/radio_field.hpp"

namespace wayfuse {

/// What would be heard on ground that nobody surveyed, but others did on more than one side of it: a fingerprint every 4 m where the
/// nearest surveyed one is 5 to 10 m off. Floor by floor, in the storeys' order; `walk` is -1.
///
/// Levels, not powers, are averaged under a Gaussian kernel as wide as the gap, by surveyed ground and not by how often the survey came by
/// (RadioField::crowd). A radio that one side does not hear is faint in between. Beyond the survey's outer edge there is nothing to
/// average, and a mean of one side would resemble every scan from there better than its own ground does: nothing is made up.
///
/// Deterministic. Cost: nodes of the lattice times a floor's fingerprints.
std::vector<SurveyFingerprint> fingerprints_between(const RadioField& field);

}  // namespace wayfuse
