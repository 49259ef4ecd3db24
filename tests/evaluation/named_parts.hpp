#pragma once

#include <string>
#include <utility>

#include "server/locating/catalogue.hpp"

namespace wayfuse {

/// What a name after --locators stands for: `NAME` or `NAME:setting=value,setting=value`, of the rows that make a locator.
Result<std::pair<const LocatorRow*, PartSettings>> locator_named(const std::string& text);

}  // namespace wayfuse
