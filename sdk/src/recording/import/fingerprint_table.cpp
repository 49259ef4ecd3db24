#include "sdk/src/recording/import/fingerprint_table.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "sdk/src/recording/import/text_line.hpp"

namespace wayfuse {
namespace {

constexpr double kNotHeard = 100.0;

struct Columns {
  std::size_t access_points = 0;
  std::map<std::string, std::size_t, std::less<>> named;
  std::optional<std::size_t> find(std::string_view name) const {
    const auto at = named.find(name);
    return at == named.end() ? std::nullopt : std::optional(at->second);
  }
};

Columns columns_of(const std::vector<std::string_view>& header) {
  Columns columns;
  for (std::size_t i = 0; i < header.size(); ++i) {
    std::string name(header[i]);
    std::erase(name, '"');
    if (name.starts_with("WAP") && i == columns.access_points)
      ++columns.access_points;
    else
      columns.named.emplace(name, i);
  }
  return columns;
}

/// Reads rows one by one; what stops a row travels as BadRow.
class RowReader {
 public:
  RowReader(const Columns& columns, std::vector<std::string> names) : columns_(columns), names_(std::move(names)) {}

  TabledScan read(const std::vector<std::string_view>& fields) const {
    if (fields.size() != names_.size()) {
      throw BadRow{0, "", std::to_string(names_.size()) + " columns expected, " + std::to_string(fields.size()) + " found"};
    }
    TabledScan scan;
    for (std::size_t i = 0; i < columns_.access_points; ++i) {
      const double level = value(fields, i);
      if (level == kNotHeard) continue;
      if (level < -120.0 || level > 0.0) throw BadRow{0, shown(names_[i]), shown(fields[i]) + " is outside -120..0 dBm and not 100"};
      scan.heard.push_back({static_cast<std::uint16_t>(i), level});
    }
    const auto named = [&](const char* name) {
      const auto at = columns_.find(name);
      return at ? value(fields, *at) : 0.0;
    };
    scan.point = {named("LONGITUDE"), named("LATITUDE")};
    scan.floor = {static_cast<std::int32_t>(std::lround(named("FLOOR")))};
    scan.building = static_cast<int>(named("BUILDINGID"));
    scan.user = static_cast<int>(named("USERID"));
    scan.phone = static_cast<int>(named("PHONEID"));
    scan.unix_s = static_cast<std::int64_t>(named("TIMESTAMP"));
    return scan;
  }

 private:
  double value(const std::vector<std::string_view>& fields, std::size_t column) const {
    const auto found = number(fields[column]);
    if (!found || std::abs(*found) > 1e12) throw BadRow{0, shown(names_[column]), "'" + shown(fields[column]) + "' is not a number, or too large"};
    return *found;
  }

  const Columns& columns_;
  const std::vector<std::string> names_;
};

}  // namespace

Result<FingerprintTable> read_uji(const std::string& path, std::vector<BadRow>* bad) {
  auto file = TextFile::read(path);
  if (!file) return file.fault();
  std::vector<std::string_view> fields;
  const auto header = file->next_line();
  if (!header) return file->fault("empty file");
  split(*header, ',', fields);
  const Columns columns = columns_of(fields);
  if (columns.access_points == 0 || columns.access_points > 65535) return file->fault("columns WAP001... expected first");
  for (const char* needed : {"LONGITUDE", "LATITUDE", "FLOOR"}) {
    if (!columns.find(needed)) return file->fault(std::string("column ") + needed + " is missing");
  }
  const RowReader rows(columns, {fields.begin(), fields.end()});
  FingerprintTable table;
  table.access_points = columns.access_points;
  while (const auto line = file->next_line()) {
    if (line->empty()) continue;
    split(*line, ',', fields);
    try {
      table.scans.push_back(rows.read(fields));
    } catch (BadRow& row) {
      if (!bad) return file->fault((row.column.empty() ? "" : row.column + ": ") + row.cause);
      row.line = file->line_number();
      bad->push_back(std::move(row));
    }
  }
  return table;
}

}  // namespace wayfuse
