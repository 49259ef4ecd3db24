#pragma once

#include <string_view>

#include "admin/http.hpp"

namespace wayfuse {

/// What stands behind `Authorization: Bearer`; empty = nothing does.
std::string_view bearer_token(const Request& request);

}  // namespace wayfuse
