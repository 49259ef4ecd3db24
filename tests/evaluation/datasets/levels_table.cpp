#include "tests/evaluation/datasets/levels_table.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>

#include "sdk/src/recording/import/text_line.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

constexpr double kAbsent = std::numeric_limits<double>::infinity();
constexpr double kNoRadioReports_dbm = -105.0;
constexpr double kLeast_dbm = -120.0;
constexpr double kOneFloor_m = 1.0;
constexpr std::size_t kMostAccessPoints = 65535;

/// Numbers by row; kAbsent where a field is empty or `nan`.
struct Grid {
  std::string path;
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;
  double at(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

char separator_of(std::string_view line) {
  for (const char separator : {',', ';', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

// Empty = nothing heard.
std::optional<double> entry(std::string_view field) {
  std::string word;
  for (const char c : field) {
    if (c != ' ' && c != '"' && c != '\r') word.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
  }
  if (word.empty() || word == "nan" || word == "na" || word == "null") return kAbsent;
  return number(word);
}

Result<Grid> read_grid(const std::string& path) {
  auto file = TextFile::read(path);
  if (!file) return file.fault();
  Grid grid{path, 0, 0, {}};
  std::vector<std::string_view> fields;
  char separator = ',';
  while (const auto line = file->next_line()) {
    if (line->find_first_not_of(" \t") == std::string_view::npos) continue;
    if (grid.rows == 0) separator = separator_of(*line);
    split(*line, separator, fields);
    if (grid.rows == 0 && grid.columns == 0) {
      const bool header = std::ranges::any_of(fields, [](std::string_view field) { return !entry(field); });
      grid.columns = fields.size();
      if (header) continue;
    }
    if (fields.size() != grid.columns) {
      return file->fault(std::to_string(grid.columns) + " columns expected, " + std::to_string(fields.size()) + " found");
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto value = entry(fields[i]);
      if (!value) return file->fault("column " + std::to_string(i + 1) + ": not a number");
      grid.values.push_back(*value);
    }
    ++grid.rows;
  }
  if (grid.rows == 0) return Fault{FaultCode::kMalformed, path, "holds no numbers"};
  return grid;
}

Grid turned(const Grid& grid) {
  Grid other{grid.path, grid.columns, grid.rows, std::vector<double>(grid.values.size())};
  for (std::size_t r = 0; r < grid.rows; ++r) {
    for (std::size_t c = 0; c < grid.columns; ++c) other.values[c * other.columns + r] = grid.at(r, c);
  }
  return other;
}

/// How a table writes levels.
struct Spelling {
  double above = 0.0;                                                ///< added to a number to have dBm
  double not_heard = std::numeric_limits<double>::quiet_NaN();       ///< besides positive numbers
};

Spelling spelling_of(const Grid& levels) {
  std::size_t numbers = 0, zeros = 0, other_than_100 = 0;
  bool negative = false;
  std::map<double, std::size_t> low;
  for (const double value : levels.values) {
    if (!std::isfinite(value)) continue;
    ++numbers;
    zeros += value == 0.0;
    other_than_100 += value != 100.0;
    negative = negative || value < 0.0;
    if (value <= kNoRadioReports_dbm) ++low[value];
  }
  if (!negative && zeros > 0 && other_than_100 > zeros) return {-100.0, -100.0};
  Spelling spelling;
  const auto commonest = std::ranges::max_element(low, {}, [](const auto& entry) { return entry.second; });
  if (commonest != low.end() && 10 * commonest->second >= numbers) spelling.not_heard = commonest->first;
  return spelling;
}

Result<std::vector<TabledScan>> scans_of(const Grid& levels) {
  const Spelling spelling = spelling_of(levels);
  std::vector<TabledScan> scans(levels.rows);
  for (std::size_t r = 0; r < levels.rows; ++r) {
    for (std::size_t c = 0; c < levels.columns; ++c) {
      const double rss_dbm = levels.at(r, c) + spelling.above;
      if (!std::isfinite(rss_dbm) || rss_dbm > 0.0 || rss_dbm == spelling.not_heard) continue;
      if (rss_dbm < kLeast_dbm) {
        return Fault{FaultCode::kOutOfRange, levels.path,
                     "scan " + std::to_string(r + 1) + ", access point " + std::to_string(c + 1) + ": level outside -120..0 dBm and no sign for not heard"};
      }
      scans[r].heard.push_back({static_cast<std::uint16_t>(c), rss_dbm});
    }
  }
  return scans;
}

/// One pair, floors still as the file's z.
struct Pair {
  FingerprintTable table;
  std::vector<double> z;
};

Result<Pair> read_pair(const LevelsFiles& files) {
  auto places = read_grid(files.places);
  if (!places) return places.fault();
  if (places->columns > 16 && places->rows <= 16) *places = turned(*places);
  if (places->columns < 2) return Fault{FaultCode::kMalformed, files.places, "x,y,z or x,y expected"};
  auto levels = read_grid(files.levels);
  if (!levels) return levels.fault();
  if (levels->rows != places->rows && levels->columns == places->rows) *levels = turned(*levels);
  if (levels->rows != places->rows) {
    return Fault{FaultCode::kMalformed, files.levels, std::to_string(levels->rows) + " scans of " + std::to_string(levels->columns) +
                                                          " access points, but " + std::to_string(places->rows) + " places in " + files.places};
  }
  if (levels->columns > kMostAccessPoints) return Fault{FaultCode::kOutOfRange, files.levels, "more than 65535 access points"};
  auto scans = scans_of(*levels);
  if (!scans) return scans.fault();
  Pair pair{{levels->columns, *std::move(scans)}, {}};
  for (std::size_t i = 0; i < places->rows; ++i) {
    const double x = places->at(i, 0), y = places->at(i, 1), z = places->columns > 2 ? places->at(i, 2) : 0.0;
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
      return Fault{FaultCode::kMalformed, files.places, "place " + std::to_string(i + 1) + ": a coordinate is missing"};
    }
    pair.table.scans[i].point = {x, y};
    pair.z.push_back(z);
  }
  return pair;
}

// Heights or numbers, ascending; a gap of a metre begins another floor.
std::map<double, std::int32_t> count_floors(const std::vector<Pair>& pairs) {
  std::map<double, std::int32_t> floors;
  for (const Pair& pair : pairs) {
    for (const double z : pair.z) floors[z] = 0;
  }
  std::int32_t floor = 0;
  double before = floors.begin()->first;
  for (auto& [z, ordinal] : floors) {
    if (z - before >= kOneFloor_m) ++floor;
    ordinal = floor;
    before = z;
  }
  return floors;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool any_in(const std::string& name, std::initializer_list<const char*> words) {
  return std::ranges::any_of(words, [&](const char* word) { return name.find(word) != std::string::npos; });
}

std::optional<fs::path> places_of(const fs::path& levels) {
  const std::string name = levels.filename().string();
  const std::size_t at = lower(name).find("rss");
  for (const char* word : {"crd", "coordinates", "coords", "coord", "xyz", "Coordinates", "CRD"}) {
    const fs::path path = levels.parent_path() / (name.substr(0, at) + word + name.substr(at + 3));
    if (fs::exists(path)) return path;
  }
  return std::nullopt;
}

}  // namespace

Result<std::vector<FingerprintTable>> read_levels(std::span<const LevelsFiles> files) {
  std::vector<Pair> pairs;
  for (const LevelsFiles& each : files) {
    auto pair = read_pair(each);
    if (!pair) return pair.fault();
    if (!pairs.empty() && pair->table.access_points != pairs.front().table.access_points) {
      return Fault{FaultCode::kOutOfRange, each.levels, std::to_string(pair->table.access_points) + " access points, " +
                                                            std::to_string(pairs.front().table.access_points) + " in " + files[0].levels};
    }
    pairs.push_back(*std::move(pair));
  }
  if (pairs.empty()) return Fault{FaultCode::kMissingField, "levels", "no files"};
  const auto floors = count_floors(pairs);
  std::vector<FingerprintTable> tables;
  for (Pair& pair : pairs) {
    for (std::size_t i = 0; i < pair.z.size(); ++i) pair.table.scans[i].floor = {floors.at(pair.z[i])};
    tables.push_back(std::move(pair.table));
  }
  return tables;
}

Result<LevelsCollection> find_levels(const std::string& folder) {
  std::error_code error;
  std::vector<fs::path> names;
  for (auto it = fs::recursive_directory_iterator(folder, error); !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    const std::string name = lower(it->path().filename().string());
    if (it->is_regular_file() && any_in(name, {"rss"}) && any_in(name, {".csv", ".txt", ".dat"})) names.push_back(it->path());
  }
  if (error) return Fault{FaultCode::kNotFound, folder, "cannot be read: " + error.message()};
  std::ranges::sort(names);
  LevelsCollection found;
  std::optional<fs::path> first_training;
  for (const fs::path& levels : names) {
    const auto places = places_of(levels);
    if (!places) return Fault{FaultCode::kNotFound, levels.string(), "no places beside it (crd, coord, coordinates or xyz instead of rss)"};
    const std::string name = lower(levels.filename().string());
    const fs::path below = fs::relative(levels.parent_path(), folder);
    const LevelsFiles files{levels.string(), places->string(), below == "." ? "" : below.generic_string()};
    if (any_in(name, {"trn", "train"})) {
      if (!first_training) first_training = levels.parent_path();
      if (*first_training == levels.parent_path()) found.training.push_back(files);
    } else if (any_in(name, {"tst", "test", "val"})) {
      found.test.push_back(files);
    }
  }
  if (found.training.empty() || found.test.empty()) {
    return Fault{FaultCode::kNotFound, folder, "no *rss* files of both training (trn, train) and test (tst, test, val)"};
  }
  return found;
}

}  // namespace wayfuse
