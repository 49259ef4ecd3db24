#include "admin/cli/completion.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace wayfuse::cli {
namespace {

const CLI::App* command_named(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == name) return command;
  }
  return nullptr;
}

// The option of this command or of one above it.
const CLI::Option* option_named(const CLI::App* app, const std::string& name) {
  for (; app; app = app->get_parent()) {
    for (const CLI::Option* option : app->get_options()) {
      if (!option->get_positional() && option->check_name(name)) return option;
    }
  }
  return nullptr;
}

// `TEXT:{csv,geojson}` names the values that are taken.
std::vector<std::string> values_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto begin = type.find('{'), end = type.find('}');
  std::vector<std::string> values;
  if (begin == std::string::npos || end == std::string::npos) return values;
  for (std::size_t at = begin + 1; at < end;) {
    const std::size_t comma = std::min(type.find(',', at), end);
    values.push_back(type.substr(at, comma - at));
    at = comma + 1;
  }
  return values;
}

}  // namespace

std::vector<std::string> completions(const CLI::App& app, std::span<const std::string> words) {
  const CLI::App* command = &app;
  const CLI::Option* awaits_value = nullptr;
  const std::string begun = words.empty() ? "" : words.back();
  for (const std::string& word : words.first(words.empty() ? 0 : words.size() - 1)) {
    if (awaits_value) {
      awaits_value = nullptr;
    } else if (word.starts_with("-")) {
      const CLI::Option* option = option_named(command, word);
      if (option && option->get_items_expected_max() > 0) awaits_value = option;
    } else if (const CLI::App* next = command_named(*command, word)) {
      command = next;
    }
  }
  std::vector<std::string> found;
  if (awaits_value) {
    found = values_of(*awaits_value);
  } else {
    if (!begun.starts_with("-")) {
      for (const CLI::App* next : command->get_subcommands([](const CLI::App* one) { return !one->get_group().empty(); })) {
        found.push_back(next->get_name());
      }
    }
    if (begun.starts_with("-")) {
      for (const CLI::App* at = command; at; at = at->get_parent()) {
        for (const CLI::Option* option : at->get_options()) {
          for (const std::string& name : option->get_lnames()) found.push_back("--" + name);
        }
      }
    }
  }
  std::erase_if(found, [&](const std::string& one) { return !one.starts_with(begun); });
  std::ranges::sort(found);
  found.erase(std::ranges::unique(found).begin(), found.end());
  return found;
}

}  // namespace wayfuse::cli
