#include "wayfuse/proto/part.hpp"

#include <cassert>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace wayfuse {
namespace {

std::string number(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

std::string known_settings(const PartDescription& part) {
  if (part.settings.empty()) return "`" + part.name + "` has no settings";
  std::string text = "known: ";
  for (const auto& setting : part.settings) {
    if (&setting != &part.settings.front()) text += ", ";
    text += setting.name + " (" + number(setting.least) + ".." + number(setting.most) + ")";
  }
  return text;
}

const SettingDescription* find(const PartDescription& part, const std::string& name) {
  for (const auto& setting : part.settings) {
    if (setting.name == name) return &setting;
  }
  return nullptr;
}

// What the assertion cannot say: which setting was asked for, and which there are.
[[maybe_unused]] bool tell_missing(std::string_view name, const std::map<std::string, double, std::less<>>& values) {
  std::string known;
  for (const auto& [each, _] : values) known += (known.empty() ? "" : ", ") + each;
  std::fprintf(stderr, "the part's row describes no setting `%s`; it has: %s\n", std::string(name).c_str(), known.empty() ? "none" : known.c_str());
  return false;
}

}  // namespace

double PartSettings::operator[](std::string_view name) const {
  const auto found = values_.find(name);
  assert(found != values_.end() || tell_missing(name, values_));
  return found->second;
}

Result<PartSettings> check_settings(const PartDescription& part, const PartChoice& choice, std::string_view field) {
  PartSettings checked;
  for (const auto& setting : part.settings) checked.values_[setting.name] = setting.standard;
  for (const auto& [name, value] : choice.settings) {
    const std::string path = std::string(field) + "." + name;
    const SettingDescription* setting = find(part, name);
    if (!setting) return Fault{FaultCode::kUnknownName, path, "no such setting; " + known_settings(part)};
    if (!std::isfinite(value) || value < setting->least || value > setting->most) {
      return Fault{FaultCode::kOutOfRange, path,
                   number(value) + " is outside " + number(setting->least) + ".." + number(setting->most)};
    }
    if (setting->whole && value != std::floor(value)) {
      return Fault{FaultCode::kOutOfRange, path, number(value) + " is not a whole number"};
    }
    checked.values_[name] = value;
  }
  return checked;
}

std::string names_of(std::span<const PartDescription> parts, std::string_view role) {
  std::string text;
  for (const auto& part : parts) {
    if (part.role != role) continue;
    if (!text.empty()) text += ", ";
    text += part.name;
  }
  return text;
}

}  // namespace wayfuse
