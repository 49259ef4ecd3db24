#pragma once

#include <string>
#include <vector>

namespace wayfuse::cli {

/// Rows under headings, columns as wide as their widest cell, two spaces apart.
std::string table(const std::vector<std::string>& headings, const std::vector<std::vector<std::string>>& rows);

/// A JSON answer as people read it: a list becomes a table of the named fields, anything else indented JSON.
std::string readable(const std::string& json, const std::string& list, const std::vector<std::string>& fields);

}  // namespace wayfuse::cli
