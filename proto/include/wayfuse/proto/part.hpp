#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// A setting of a part, described once: the catalogue, the checks and the documentation read this.
struct SettingDescription {
  std::string name;        ///< with its unit, like `sigma_m`
  double standard = 0.0;   ///< default
  double least = 0.0;
  double most = 0.0;
  std::string meaning;     ///< one line, with the effect of larger and smaller
  std::string source;      ///< like `[P1 eq. 13]`
  bool whole = false;      ///< a count or a switch: no fraction allowed
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

/// The settings of one part after the check: every described setting has a value inside its range.
class PartSettings {
 public:
  PartSettings() = default;
  /// Asserts that the part describes such a setting.
  double operator[](std::string_view name) const;
  int count(std::string_view name) const { return static_cast<int>((*this)[name]); }
  bool on(std::string_view name) const { return (*this)[name] != 0.0; }

 private:
  friend Result<PartSettings> check_settings(const PartDescription&, const PartChoice&, std::string_view);
  std::map<std::string, double, std::less<>> values_;
};

/// Defaults filled in. An unknown setting or one outside its range is a fault below `field` that lists what is known.
Result<PartSettings> check_settings(const PartDescription& part, const PartChoice& choice, std::string_view field);

/// `a, b, c`, for faults that list what is known.
std::string names_of(std::span<const PartDescription> parts, std::string_view role);

}  // namespace wayfuse
