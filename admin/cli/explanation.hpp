#pragma once

#include <string>

namespace wayfuse::cli {

/// The answer of `.../sessions/TRACKED/explain` as people read it: where, how sure, on which floor, what is in doubt, then every
/// reading against the survey.
std::string explained(const std::string& json);

}  // namespace wayfuse::cli
