#include "admin/cli/table.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace wayfuse::cli {
namespace {

// Characters, not bytes: continuation bytes of UTF-8 take no column.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](unsigned char c) { return (c & 0xc0) != 0x80; }));
}

std::string cell_of(const nlohmann::ordered_json& entry, const std::string& field) {
  const auto found = entry.find(field);
  if (found == entry.end() || found->is_null()) return "-";
  if (found->is_string()) return found->get<std::string>();
  if (!found->is_array()) return found->dump();
  std::string joined;
  for (const auto& item : *found) joined += (joined.empty() ? "" : ",") + (item.is_string() ? item.get<std::string>() : item.dump());
  return joined;
}

}  // namespace

std::string table(const std::vector<std::string>& headings, const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (std::size_t column = 0; column < headings.size(); ++column) {
    std::size_t width = width_of(headings[column]);
    for (const auto& row : rows) width = std::max(width, width_of(row[column]));
    widths.push_back(width);
  }
  std::string text;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t column = 0; column < cells.size(); ++column) {
      text += cells[column];
      if (column + 1 < cells.size()) text.append(widths[column] - width_of(cells[column]) + 2, ' ');
    }
    text += '\n';
  };
  line(headings);
  for (const auto& row : rows) line(row);
  return text;
}

std::string readable(const std::string& json, const std::string& list, const std::vector<std::string>& fields) {
  const auto parsed = nlohmann::ordered_json::parse(json, nullptr, false);
  if (parsed.is_discarded()) return json + "\n";
  const auto entries = list.empty() ? parsed.end() : parsed.find(list);
  if (entries == parsed.end() || !entries->is_array()) return parsed.dump(2) + "\n";
  std::vector<std::vector<std::string>> rows;
  for (const auto& entry : *entries) {
    if (!entry.is_object()) {
      rows.push_back({entry.is_string() ? entry.get<std::string>() : entry.dump()});
      continue;
    }
    std::vector<std::string> row;
    for (const std::string& field : fields) row.push_back(cell_of(entry, field));
    rows.push_back(std::move(row));
  }
  return table(fields, rows);
}

}  // namespace wayfuse::cli
