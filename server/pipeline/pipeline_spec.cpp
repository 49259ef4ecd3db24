#include "server/pipeline/pipeline_spec.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "proto/src/wire/tree.hpp"
#include "server/locating/catalogue.hpp"
#include "server/pipeline/part_roles.hpp"
#include "server/pipeline/preset_files.hpp"
#include "server/tracking/catalogue.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::json;

Fault wrong(FaultCode code, std::string field, std::string cause) { return {code, std::move(field), std::move(cause)}; }

std::string role_names() {
  std::string text;
  for (const Role& role : pipeline_roles()) text += (text.empty() ? "" : ", ") + std::string(role.name);
  return text;
}

Result<PartChoice> parse_part(const Json& json, const std::string& field) {
  PartChoice choice;
  if (json.is_string()) {
    choice.name = json.get<std::string>();
    return choice;
  }
  if (!json.is_object()) return wrong(FaultCode::kWrongType, field, "neither a part's name nor an object with `part`");
  for (const auto& [key, value] : json.items()) {
    if (key == "part") {
      if (!value.is_string()) return wrong(FaultCode::kWrongType, field + ".part", "not a string");
      choice.name = value.get<std::string>();
    } else if (key == "settings") {
      if (!value.is_object()) return wrong(FaultCode::kWrongType, field + ".settings", "not an object");
      for (const auto& [name, number] : value.items()) {
        if (!number.is_number()) return wrong(FaultCode::kWrongType, field + ".settings." + name, "not a number");
        choice.settings[name] = number.get<double>();
      }
    } else {
      return wrong(FaultCode::kUnknownName, field + "." + key, "no such field; known: part, settings");
    }
  }
  if (choice.name.empty()) return wrong(FaultCode::kMissingField, field + ".part", "a part's name is needed");
  return choice;
}

}  // namespace

std::vector<PartDescription> part_catalogue() {
  std::vector<PartDescription> all;
  for (const auto& row : locator_catalogue()) all.push_back(row.description);
  for (const auto& row : motion_model_catalogue()) all.push_back(row.description);
  for (const auto& row : filter_catalogue()) all.push_back(row.description);
  for (const auto& row : resampler_catalogue()) all.push_back(row.description);
  for (const auto& part : pipeline_parts()) all.push_back(part);
  std::vector<PartDescription> ordered;
  for (const Role& role : pipeline_roles()) {
    for (const auto& part : all) {
      if (part.role == role.name) ordered.push_back(part);
    }
  }
  return ordered;
}

Result<void> check(const PipelineSpec& spec) {
  const auto catalogue = part_catalogue();
  for (const auto& [role, choice] : spec.parts) {
    const auto known = std::ranges::any_of(pipeline_roles(), [&](const Role& each) { return each.name == role; });
    if (!known) return wrong(FaultCode::kUnknownName, "parts." + role, "no such role; known: " + role_names());
    const auto part = std::ranges::find_if(
        catalogue, [&](const PartDescription& each) { return each.role == role && each.name == choice.name; });
    if (part == catalogue.end()) {
      return wrong(FaultCode::kUnknownName, "parts." + role + ".part",
                   "no such part `" + choice.name + "`; known: " + names_of(catalogue, role));
    }
    const auto settings = check_settings(*part, choice, "parts." + role + ".settings");
    if (!settings) return settings.fault();
  }
  return {};
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const PresetFile& file : preset_files()) names.emplace_back(file.name);
  return names;
}

Result<PipelineSpec> preset(std::string_view name) {
  std::string known;
  for (const PresetFile& file : preset_files()) {
    if (file.name == name) return parse_pipeline(file.json);
    known += (known.empty() ? "" : ", ") + std::string(file.name);
  }
  return wrong(FaultCode::kUnknownName, "pipeline", "no such preset `" + std::string(name) + "`; known: " + known);
}

Result<PipelineSpec> parse_pipeline(std::string_view text) {
  // Of a key that stands twice the reader below would drop one in silence.
  if (const auto strict = wire::parse_json(text); !strict) return strict.fault();
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return wrong(FaultCode::kMalformed, "", "not JSON");
  if (!json.is_object()) return wrong(FaultCode::kWrongType, "", "not an object");
  PipelineSpec spec;
  for (const auto& [key, value] : json.items()) {
    if (key == "name") {
      if (!value.is_string()) return wrong(FaultCode::kWrongType, "name", "not a string");
      spec.name = value.get<std::string>();
    } else if (key == "parts") {
      if (!value.is_object()) return wrong(FaultCode::kWrongType, "parts", "not an object");
      for (const auto& [role, part] : value.items()) {
        auto choice = parse_part(part, "parts." + role);
        if (!choice) return choice.fault();
        spec.parts[role] = *std::move(choice);
      }
    } else {
      return wrong(FaultCode::kUnknownName, key, "no such field; known: name, parts");
    }
  }
  if (!json.contains("parts")) return wrong(FaultCode::kMissingField, "parts", "a pipeline names its parts");
  if (auto checked = check(spec); !checked) return checked.fault();
  return spec;
}

std::string to_json(const PipelineSpec& spec) {
  Json parts = Json::object();
  for (const auto& [role, choice] : spec.parts) {
    parts[role] = {{"part", choice.name}};
    if (!choice.settings.empty()) parts[role]["settings"] = choice.settings;
  }
  return Json{{"name", spec.name}, {"parts", parts}}.dump(2);
}

}  // namespace wayfuse
