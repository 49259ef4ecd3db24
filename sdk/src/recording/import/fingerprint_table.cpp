#include "sdk/src/recording/import/fingerprint_table.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include "sdk/src/recording/import/text_line.hpp"

namespace wayfuse {
namespace {

constexpr double kNotHeard = 100.0;
constexpr double kHardlyHeard_dbm = -100.0;
constexpr double kMostWhole = 2e9;

struct Columns {
  std::vector<std::size_t> access_points;
  std::map<std::string, std::size_t, std::less<>> named;
  std::optional<std::size_t> find(std::string_view name) const {
    const auto at = named.find(name);
    return at == named.end() ? std::nullopt : std::optional(at->second);
  }
};

std::string_view unquoted(std::string_view field) {
  const auto around = [](char c) { return c == '"' || c == ' ' || c == '\t'; };
  while (!field.empty() && around(field.front())) field.remove_prefix(1);
  while (!field.empty() && around(field.back())) field.remove_suffix(1);
  return field;
}

// Upper case, without quotes.
std::vector<std::string> names_in(const std::vector<std::string_view>& header) {
  std::vector<std::string> names;
  for (const std::string_view field : header) {
    std::string& name = names.emplace_back(unquoted(field));
    for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return names;
}

Columns columns_of(const std::vector<std::string>& names) {
  Columns columns;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].starts_with("WAP"))
      columns.access_points.push_back(i);
    else
      columns.named.emplace(names[i], i);
  }
  return columns;
}

/// Reads rows one by one; what stops a row travels as BadRow.
class RowReader {
 public:
  RowReader(const Columns& columns, const std::vector<std::string>& names) : columns_(columns), names_(names) {}

  TabledScan read(const std::vector<std::string_view>& fields) const {
    if (fields.size() != names_.size()) {
      throw BadRow{0, "", std::to_string(names_.size()) + " columns expected, " + std::to_string(fields.size()) + " found"};
    }
    TabledScan scan;
    for (std::size_t i = 0; i < columns_.access_points.size(); ++i) {
      const std::size_t column = columns_.access_points[i];
      const std::string_view field = unquoted(fields[column]);
      if (field.empty() || field == "nan" || field == "NaN" || field == "NA") continue;
      const double level = value(field, column);
      if (level == kNotHeard) continue;
      if (level < -120.0 || level > 0.0) throw BadRow{0, shown(names_[column]), shown(field) + " is outside -120..0 dBm and not 100"};
      scan.heard.push_back({static_cast<std::uint16_t>(i), level});
    }
    const auto named = [&](const char* name) {
      const auto at = columns_.find(name);
      return at ? value(unquoted(fields[*at]), *at) : 0.0;
    };
    const auto whole = [&](const char* name) {
      const double number = named(name);
      if (std::abs(number) > kMostWhole) throw BadRow{0, name, "too large"};
      return static_cast<std::int32_t>(std::lround(number));
    };
    scan.point = {named("LONGITUDE"), named("LATITUDE")};
    scan.floor = {whole("FLOOR")};
    scan.building = whole("BUILDINGID");
    scan.user = whole("USERID");
    scan.phone = whole("PHONEID");
    scan.unix_s = static_cast<std::int64_t>(named("TIMESTAMP"));
    return scan;
  }

 private:
  double value(std::string_view field, std::size_t column) const {
    const auto found = number(field);
    if (!found || std::abs(*found) > 1e12) throw BadRow{0, shown(names_[column]), "'" + shown(field) + "' is not a number, or too large"};
    return *found;
  }

  const Columns& columns_;
  const std::vector<std::string>& names_;
};

// Some tables write 0, -100, -105 or -110 where nothing was heard: a level that fills more than half of all cells is none.
void drop_not_heard(FingerprintTable& table) {
  std::map<double, std::size_t> cells;
  for (const TabledScan& scan : table.scans) {
    for (const TabledScan::Heard& heard : scan.heard) {
      if (heard.rss_dbm == 0.0 || heard.rss_dbm <= kHardlyHeard_dbm) ++cells[heard.rss_dbm];
    }
  }
  for (const auto& [level, count] : cells) {
    if (2 * count <= table.access_points * table.scans.size()) continue;
    for (TabledScan& scan : table.scans) std::erase_if(scan.heard, [&](const TabledScan::Heard& heard) { return heard.rss_dbm == level; });
  }
}

}  // namespace

bool number_like(const FingerprintTable& like, FingerprintTable& table) {
  if (table.names == like.names) return true;
  std::map<std::string_view, std::uint16_t> numbers;
  for (std::size_t i = 0; i < like.names.size(); ++i) numbers.emplace(like.names[i], static_cast<std::uint16_t>(i));
  std::vector<std::uint16_t> becomes;
  for (const std::string& name : table.names) {
    const auto found = numbers.find(name);
    if (found == numbers.end()) return false;
    becomes.push_back(found->second);
  }
  if (becomes.size() != like.names.size() || numbers.size() != becomes.size()) return false;
  for (TabledScan& scan : table.scans) {
    for (TabledScan::Heard& heard : scan.heard) heard.access_point = becomes[heard.access_point];
    std::ranges::sort(scan.heard, {}, &TabledScan::Heard::access_point);
  }
  table.names = like.names;
  return true;
}

Result<FingerprintTable> read_uji(const std::string& path, std::vector<BadRow>* bad) {
  auto file = TextFile::read(path);
  if (!file) return file.fault();
  std::vector<std::string_view> fields;
  const auto header = file->next_line();
  if (!header) return file->fault("empty file");
  const char separator = header->find(',') != std::string_view::npos ? ',' : header->find(';') != std::string_view::npos ? ';' : '\t';
  split(*header, separator, fields);
  const std::vector<std::string> names = names_in(fields);
  const Columns columns = columns_of(names);
  if (columns.access_points.empty() || columns.access_points.size() > 65535) return file->fault("a header with columns WAP001... expected");
  for (const char* needed : {"LONGITUDE", "LATITUDE", "FLOOR"}) {
    if (!columns.find(needed)) return file->fault(std::string("column ") + needed + " is missing");
  }
  const RowReader rows(columns, names);
  FingerprintTable table;
  table.access_points = columns.access_points.size();
  for (const std::size_t column : columns.access_points) table.names.push_back(names[column]);
  while (const auto line = file->next_line()) {
    if (line->find_first_not_of(" \t") == std::string_view::npos) continue;
    split(*line, separator, fields);
    try {
      table.scans.push_back(rows.read(fields));
    } catch (BadRow& row) {
      if (!bad) return file->fault((row.column.empty() ? "" : row.column + ": ") + row.cause);
      row.line = file->line_number();
      bad->push_back(std::move(row));
    }
  }
  drop_not_heard(table);
  return table;
}

}  // namespace wayfuse
