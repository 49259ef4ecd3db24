#pragma once

#include <CLI/App.hpp>
#include <span>
#include <string>
#include <vector>

namespace wayfuse::cli {

/// What may stand at the place of the last of `words` (the words after the program's name, the last one possibly empty or half
/// written): commands, flags, or the values an option takes. Empty = a file name or free text. Read from the commands themselves.
std::vector<std::string> completions(const CLI::App& app, std::span<const std::string> words);

}  // namespace wayfuse::cli
