#pragma once

#include <span>
#include <string>
#include <string_view>

#include "wayfuse/proto/part.hpp"

namespace wayfuse {

/// A role of a pipeline and the part that plays it when a spec does not say.
struct Role {
  std::string_view name;
  std::string_view standard;
  std::string_view meaning;
};

/// All roles, in reading order: from the scan to the position.
std::span<const Role> pipeline_roles();

/// Parts of the roles that live in this room: readings, measurement, floor, heading, speed, azimuth, gnss, recovery.
std::span<const PartDescription> pipeline_parts();

}  // namespace wayfuse
