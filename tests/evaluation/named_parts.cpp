#include "tests/evaluation/named_parts.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
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

}  // namespace wayfuse
