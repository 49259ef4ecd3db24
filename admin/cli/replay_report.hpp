#pragma once

#include <string>

namespace wayfuse::cli {

/// The answer of `.../recordings/ID/replay` as people read it: whether it came out as it was, then a line a step.
std::string replayed(const std::string& json);

}  // namespace wayfuse::cli
