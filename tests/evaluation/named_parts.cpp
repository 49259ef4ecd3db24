#include "tests/evaluation/named_parts.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <vector>

namespace wayfuse {
namespace {

constexpr const char* kBySpaces = "; locators are separated by spaces";

// `NAME` or `NAME:change,change`
struct Words {
  std::string name;
  std::vector<std::string> changes;

  Words(const std::string& text, char separator) : name(text.substr(0, text.find(':'))) {
    for (std::size_t at = name.size(); at < text.size();) {
      const std::size_t end = std::min(text.find(separator, at + 1), text.size());
      changes.push_back(text.substr(at + 1, end - at - 1));
      at = end;
    }
  }
};

// `setting=number`; absent where the text says anything else.
std::optional<std::pair<std::string, double>> parse_setting(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) return std::nullopt;
  const char* number = text.c_str() + equals + 1;
  char* end = nullptr;
  const double value = std::strtod(number, &end);
  if (end == number || *end != '\0') return std::nullopt;
  return std::pair{text.substr(0, equals), value};
}

// Of those that make a locator; null: none of them.
const LocatorRow* locating_row(const std::string& name) {
  const auto rows = locator_catalogue();
  const auto found = std::ranges::find_if(rows, [&](const LocatorRow& row) { return row.prepare && row.description.name == name; });
  return found == rows.end() ? nullptr : &*found;
}

std::string locating_names() {
  std::string names;
  for (const LocatorRow& row : locator_catalogue()) {
    if (row.prepare) names += (names.empty() ? "" : ", ") + row.description.name;
  }
  return names;
}

bool is_preset(const std::string& name) { return name.find(':') == std::string::npos && !name.ends_with(".json"); }

// A pipeline that is no preset: for comparing settings.
Result<PipelineSpec> from_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) return Fault{FaultCode::kNotFound, "", "cannot be read"};
  return parse_pipeline(std::string(std::istreambuf_iterator<char>(file), {}));
}

std::string roles_of(const PipelineSpec& spec) {
  std::string roles;
  for (const auto& [role, _] : spec.parts) roles += (roles.empty() ? "" : ", ") + role;
  return roles;
}

// `default:filter.walkable=0+locator.learn=0`: a preset with these settings instead of its own.
Result<PipelineSpec> changed(const std::string& pipeline) {
  const Words words(pipeline, '+');
  auto spec = preset(words.name);
  if (!spec) return spec;
  std::set<std::string> given;
  for (const std::string& change : words.changes) {
    const auto setting = parse_setting(change);
    const std::size_t dot = setting ? setting->first.find('.') : std::string::npos;
    const auto part = dot == std::string::npos ? spec->parts.end() : spec->parts.find(setting->first.substr(0, dot));
    if (part == spec->parts.end()) {
      return Fault{FaultCode::kMalformed, "", "`" + change + "` is not role.setting=number of a role the preset fills: " + roles_of(*spec)};
    }
    if (!given.insert(setting->first).second) return Fault{FaultCode::kDuplicateField, "", "`" + setting->first + "` stands twice"};
    part->second.settings[setting->first.substr(dot + 1)] = setting->second;
  }
  if (auto checked = check(*spec); !checked) return checked.fault();
  return spec;
}

Fault fault_of(const std::string& pipeline, const Fault& fault) {
  return {fault.code, pipeline + (fault.field.empty() ? "" : ": " + fault.field), fault.cause};
}

}  // namespace

Result<std::pair<const LocatorRow*, PartSettings>> locator_named(const std::string& text) {
  const Words words(text, ',');
  const LocatorRow* row = locating_row(words.name);
  if (!row) {
    const char* hint = words.name.find(',') == std::string::npos ? "" : kBySpaces;
    return Fault{FaultCode::kUnknownName, "locators", "no such locator `" + words.name + "`; known: " + locating_names() + hint};
  }
  const std::string field = "locators." + words.name;
  PartChoice choice{words.name, {}};
  for (const std::string& change : words.changes) {
    const bool another = locating_row(change.substr(0, change.find(':'))) != nullptr;
    const auto setting = parse_setting(change);
    if (!setting || another) return Fault{FaultCode::kMalformed, field, "`" + change + "` is not setting=number" + (another ? kBySpaces : "")};
    if (!choice.settings.insert(*setting).second) return Fault{FaultCode::kDuplicateField, field + "." + setting->first, "stands twice"};
  }
  auto settings = check_settings(row->description, choice, field);
  if (!settings) return settings.fault();
  return std::pair{row, *std::move(settings)};
}

Result<PipelineSpec> pipeline_named(const std::string& name) {
  if (is_preset(name)) return preset(name);
  auto spec = name.ends_with(".json") ? from_file(name) : changed(name);
  if (!spec) return fault_of(name, spec.fault());
  return spec;
}

Result<std::shared_ptr<const TrackerFactory>> assemble_named(const std::string& name, std::shared_ptr<const Site> site) {
  const auto spec = pipeline_named(name);
  if (!spec) return spec.fault();
  auto factory = assemble(*spec, std::move(site));
  if (!factory) return fault_of(name, factory.fault());
  return factory;
}

Result<void> check_pipelines(std::span<const std::string> names, AskedOf asked) {
  for (const std::string& name : names) {
    if (asked == AskedOf::kSessions && !is_preset(name)) {
      return Fault{FaultCode::kUnknownName, name, "is no preset's name, and a session knows no other: it needs --direct"};
    }
    const auto factory = assemble_named(name, std::make_shared<Site>());
    if (!factory) return factory.fault();
  }
  return {};
}

}  // namespace wayfuse
