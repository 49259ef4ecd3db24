#pragma once

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/proto/golden.hpp"

namespace wayfuse {

using ReadmeRow = std::vector<std::string>;

/// What stands under one heading of proto/README.md.
struct ReadmeSection {
  std::string words;                ///< its first paragraph, one line
  std::vector<ReadmeRow> rows;      ///< of its table, without head and rule
  std::vector<std::string> blocks;  ///< ```json
};

inline std::string trimmed(std::string text) {
  const auto blank = [](char c) { return c == ' '; };
  text.erase(text.begin(), std::ranges::find_if_not(text, blank));
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

inline ReadmeRow cells(const std::string& line) {
  ReadmeRow row;
  std::istringstream in(line.substr(1));
  for (std::string cell; std::getline(in, cell, '|');) row.push_back(trimmed(cell));
  return row;
}

/// By title, `## ` and `### ` alike.
inline std::map<std::string, ReadmeSection> readme_sections() {
  std::map<std::string, ReadmeSection> found;
  std::istringstream in(contents(std::filesystem::path(WAYFUSE_SOURCE_DIR) / "proto/README.md"));
  std::string title;
  bool in_json = false;
  for (std::string line; std::getline(in, line);) {
    ReadmeSection& section = found[title];
    if (line == "```json") {
      in_json = true;
      section.blocks.emplace_back();
    } else if (in_json && line == "```") {
      in_json = false;
    } else if (in_json) {
      section.blocks.back() += line + '\n';
    } else if (line.starts_with("#")) {
      title = trimmed(line.substr(line.find_first_not_of('#')));
    } else if (line.starts_with("|")) {
      section.rows.push_back(cells(line));
    } else if (!line.empty() && section.rows.empty() && section.blocks.empty()) {
      section.words += (section.words.empty() ? "" : " ") + line;
    }
  }
  for (auto& [_, section] : found) {
    if (section.rows.size() >= 2) section.rows.erase(section.rows.begin(), section.rows.begin() + 2);
  }
  return found;
}

}  // namespace wayfuse
