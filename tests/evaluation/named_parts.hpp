#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>

#include "server/locating/catalogue.hpp"
#include "server/pipeline/pipeline_spec.hpp"
#include "server/pipeline/tracker.hpp"

namespace wayfuse {

/// What a name after --locators stands for: `NAME` or `NAME:setting=value,setting=value`, of the rows that make a locator.
Result<std::pair<const LocatorRow*, PartSettings>> locator_named(const std::string& text);

/// What a name after --pipelines stands for: a preset, a file `NAME.json`, or a preset with settings changed,
/// `PRESET:role.setting=value+role.setting=value`. Its parts and settings are checked; faults name it.
Result<PipelineSpec> pipeline_named(const std::string& name);
/// The same, prepared for a building: its parts fit together.
Result<std::shared_ptr<const TrackerFactory>> assemble_named(const std::string& name, std::shared_ptr<const Site> site);

/// Who replays walks through the pipelines.
enum class AskedOf { kSessions, kPipelines };
/// Whether all these pipelines can be made, before a survey takes its time. A session is asked for presets alone: the rest needs --direct.
Result<void> check_pipelines(std::span<const std::string> names, AskedOf asked);

}  // namespace wayfuse
