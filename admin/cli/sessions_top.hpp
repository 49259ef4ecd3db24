#pragma once

#include <cstddef>
#include <string>

namespace wayfuse::cli {

/// Live sessions as `top` shows processes: the widest stated circle first, samples a second since the answer before. Both are answers of
/// GET /v1/sessions; an empty `before` = none, and then no rates. `most` = rows at the most.
std::string top_of(const std::string& now, const std::string& before, double seconds_between, std::size_t most);

}  // namespace wayfuse::cli
