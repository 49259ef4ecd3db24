#pragma once

#include <cctype>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace wayfuse {

/// A row of a table of hostile inputs.
struct HostileCase {
  std::string where;  ///< file and line
  bool from_client = true;
  std::string expected;  ///< a fault's name, or `ok`
  std::string field;     ///< the fault's path begins with this
  std::string frame;
};

/// `<ff>` is a byte, `<9*ab>` repeats what follows the asterisk.
inline std::string expanded(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t end = text[i] == '<' ? text.find('>', i) : std::string::npos;
    const std::string inner = end == std::string::npos ? "" : text.substr(i + 1, end - i - 1);
    const std::size_t star = inner.find('*');
    if (inner.size() == 2 && std::isxdigit(static_cast<unsigned char>(inner[0])) &&
        std::isxdigit(static_cast<unsigned char>(inner[1]))) {
      out += static_cast<char>(std::strtol(inner.c_str(), nullptr, 16));
      i = end;
    } else if (star != std::string::npos && star > 0 && std::isdigit(static_cast<unsigned char>(inner[0]))) {
      for (long times = std::strtol(inner.c_str(), nullptr, 10); times > 0; --times) out += inner.substr(star + 1);
      i = end;
    } else {
      out += text[i];
    }
  }
  return out;
}

inline std::string from_hex(const std::string& text) {
  std::string bytes;
  std::string digits;
  for (const char c : text) {
    if (c == ' ') continue;
    digits += c;
    if (digits.size() == 2) {
      bytes += static_cast<char>(std::strtol(digits.c_str(), nullptr, 16));
      digits.clear();
    }
  }
  return bytes;
}

/// Reads a table as hostile_fields.txt describes it.
inline std::vector<HostileCase> hostile_cases(const std::string& name, bool hexadecimal) {
  std::vector<HostileCase> cases;
  std::ifstream in(std::string(WAYFUSE_SOURCE_DIR) + "/tests/proto/" + name);
  std::string pattern;
  HostileCase row;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    row.where = name + ':' + std::to_string(++number);
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string first;
    words >> first;
    const std::string rest = line.size() > first.size() ? line.substr(first.size() + 1) : "";
    if (first[0] == '@') {
      row.from_client = first == "@client";
      pattern = rest;
    } else if (first == "field") {
      row.field = rest;
    } else {
      row.expected = first;
      const std::size_t hole = pattern.find('$');
      const std::string filled = expanded(pattern.substr(0, hole)) + expanded(rest) + expanded(pattern.substr(hole + 1));
      row.frame = hexadecimal ? from_hex(filled) : filled;
      cases.push_back(row);
    }
  }
  return cases;
}

}  // namespace wayfuse
