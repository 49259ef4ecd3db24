#pragma once

#include <vector>

#include "server/checkup.hpp"

namespace wayfuse {

/// Certificate and key: there, readable, belonging together, valid now and for 30 days, the key closed to others.
void check_certificate(const NetSettings& net, std::vector<Finding>& findings);

}  // namespace wayfuse
