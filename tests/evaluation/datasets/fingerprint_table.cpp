#include "tests/evaluation/datasets/fingerprint_table.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "sdk/src/recording/import/text_line.hpp"

namespace wayfuse {
namespace {

constexpr double kNotHeard = 100.0;

// Empty = fine; otherwise the cause.
std::string take_levels(const std::vector<std::string_view>& fields, std::size_t count, TabledScan& scan) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto level = number(fields[i]);
    if (!level) return "column " + std::to_string(i + 1) + ": not a number";
    if (*level == kNotHeard) continue;
    if (*level < -120.0 || *level > 0.0) return "column " + std::to_string(i + 1) + ": level outside -120..0 dBm and not 100";
    scan.heard.push_back({static_cast<std::uint16_t>(i), *level});
  }
  return "";
}

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

}  // namespace

Result<FingerprintTable> read_uji(const std::string& path) {
  auto file = TextFile::read(path);
  if (!file) return file.fault();
  std::vector<std::string_view> fields;
  const auto header = file->next_line();
  if (!header) return file->fault("empty file");
  split(*header, ',', fields);
  const Columns columns = columns_of(fields);
  if (columns.access_points == 0 || columns.access_points > 65535) return file->fault("columns WAP001... expected first");
  const std::size_t width = fields.size();
  FingerprintTable table;
  table.access_points = columns.access_points;
  for (const char* needed : {"LONGITUDE", "LATITUDE", "FLOOR"}) {
    if (!columns.find(needed)) return file->fault(std::string("column ") + needed + " is missing");
  }
  while (const auto line = file->next_line()) {
    if (line->empty()) continue;
    split(*line, ',', fields);
    if (fields.size() != width)
      return file->fault(std::to_string(width) + " columns expected, " + std::to_string(fields.size()) + " found");
    TabledScan scan;
    const std::string cause = take_levels(fields, columns.access_points, scan);
    if (!cause.empty()) return file->fault(cause);
    bool bad = false;
    const auto value = [&](const char* name) {
      const auto at = columns.find(name);
      if (!at) return 0.0;
      const auto found = number(fields[*at]);
      bad = bad || !found;
      return found.value_or(0.0);
    };
    scan.point = {value("LONGITUDE"), value("LATITUDE")};
    scan.floor = {static_cast<std::int32_t>(std::lround(value("FLOOR")))};
    scan.building = static_cast<int>(value("BUILDINGID"));
    scan.user = static_cast<int>(value("USERID"));
    scan.phone = static_cast<int>(value("PHONEID"));
    scan.unix_s = static_cast<std::int64_t>(value("TIMESTAMP"));
    if (bad) return file->fault("place, building, user, phone or time is not a number");
    table.scans.push_back(std::move(scan));
  }
  return table;
}

}  // namespace wayfuse
