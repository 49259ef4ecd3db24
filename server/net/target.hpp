#pragma once

#include <map>
#include <string>
#include <string_view>

#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// A request target taken apart: percent signs decoded, `+` in the query a space.
struct Target {
  std::string path;
  std::map<std::string, std::string> query;
};

/// Origin form only (`/path?query`). Refused: other forms, broken escapes, control characters, `.` and `..` segments.
Result<Target> parse_target(std::string_view target);

/// The token of an Authorization header's `Bearer` scheme; empty if it is another.
std::string_view bearer_token(std::string_view authorization);

}  // namespace wayfuse
