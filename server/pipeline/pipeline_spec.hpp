#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/part.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// One choice a row: which part plays which role, with which settings. Presets are files of this shape.
struct PipelineSpec {
  std::string name;
  std::map<std::string, PartChoice> parts;  ///< role (`locator`, `motion`, `measurement`, `filter`, ...) -> part
  bool operator==(const PipelineSpec&) const = default;
};

/// Names of the presets that come with the server, and one by name (kUnknownName lists the known ones).
std::vector<std::string> preset_names();
Result<PipelineSpec> preset(std::string_view name);

/// From strict JSON, no key twice; unknown roles, parts, settings and values out of range are faults that list what is known.
Result<PipelineSpec> parse_pipeline(std::string_view json);
std::string to_json(const PipelineSpec& spec);

/// Names, parts and settings of a spec made by hand; parse_pipeline() and assemble() check on their own.
Result<void> check(const PipelineSpec& spec);

/// Every part of every role with its settings: what the admin API and the documentation show.
std::vector<PartDescription> part_catalogue();

}  // namespace wayfuse
