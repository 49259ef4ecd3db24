#pragma once

#include <map>
#include <string>
#include <vector>

namespace wayfuse {

/// A setting of a part, described once: the catalogue, the checks and the documentation read this.
struct SettingDescription {
  std::string name;        ///< with its unit, like `sigma_m`
  double standard = 0.0;   ///< default
  double least = 0.0;
  double most = 0.0;
  std::string meaning;     ///< one line, with the effect of larger and smaller
  std::string source;      ///< like `[P1 eq. 13]`
};

/// A part: one row of its room's catalogue.
struct PartDescription {
  std::string role;        ///< like `locator`
  std::string name;        ///< like `wknn`
  std::string summary;
  std::vector<SettingDescription> settings;
};

/// A part chosen by name, with the settings that differ from the defaults.
struct PartChoice {
  std::string name;
  std::map<std::string, double> settings;
  bool operator==(const PartChoice&) const = default;
};

}  // namespace wayfuse
