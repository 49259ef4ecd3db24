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
constexpr double kHardlyHeard_dbm = -100.0;
constexpr double kLeast_dbm = -120.0;
constexpr double kFaintest_dB = -20.0;  // of decibels above -100: -120 dBm
constexpr double kOneFloor_m = 1.0;
constexpr int kDeepest = 6;  // folders below the collection's
constexpr std::size_t kMostAccessPoints = 65535;
constexpr std::size_t kMostPlaceColumns = 16;
constexpr std::size_t kFewestCounted = 5;  // rows, before their numbers tell an index from a coordinate
constexpr double kDegreesMost = 0.5;       // a site's extent

/// Numbers by row; kAbsent where a field is empty or `nan`.
struct Grid {
  std::string path;
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;
  std::vector<std::string> names;  // of the columns, lower case; empty = no header
  double at(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

char separator_of(std::string_view line) {
  for (const char separator : {';', '\t', ','}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

// Empty = nothing heard.
std::optional<double> entry(std::string_view field) {
  std::string word;
  for (const char c : field) {
    if (c == ',') word.push_back('.');  // a decimal comma: fields are parted by something else
    else if (c != ' ' && c != '"' && c != '\r') word.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
  }
  for (const char* nothing : {"", "nan", "na", "n/a", "null", "none", "-", "?"}) {
    if (word == nothing) return kAbsent;
  }
  return number(word);
}

std::string name_in(std::string_view field) {
  std::string name;
  for (const char c : field) {
    if (c != ' ' && c != '"' && c != '\t') name.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
  }
  return name;
}

Result<Grid> read_grid(const std::string& path) {
  auto file = TextFile::read(path);
  if (!file) return file.fault();
  Grid grid{path, 0, 0, {}, {}};
  std::vector<std::string_view> fields;
  char separator = ',';
  while (const auto line = file->next_line()) {
    if (line->find_first_not_of(" \t") == std::string_view::npos) continue;
    if (grid.rows == 0) separator = separator_of(*line);
    split(*line, separator, fields);
    if (grid.rows == 0 && grid.columns == 0) {
      const bool header = std::ranges::any_of(fields, [](std::string_view field) { return !entry(field); });
      grid.columns = fields.size();
      if (header) {
        for (const std::string_view field : fields) grid.names.push_back(name_in(field));
        continue;
      }
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
  Grid other{grid.path, grid.columns, grid.rows, std::vector<double>(grid.values.size()), {}};
  for (std::size_t r = 0; r < grid.rows; ++r) {
    for (std::size_t c = 0; c < grid.columns; ++c) other.values[c * other.columns + r] = grid.at(r, c);
  }
  return other;
}

void drop_first_row(Grid& grid) {
  grid.values.erase(grid.values.begin(), grid.values.begin() + static_cast<std::ptrdiff_t>(grid.columns));
  --grid.rows;
}

void drop_first_column(Grid& grid) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < grid.values.size(); ++i) {
    if (i % grid.columns != 0) grid.values[kept++] = grid.values[i];
  }
  grid.values.resize(kept);
  --grid.columns;
  if (!grid.names.empty()) grid.names.erase(grid.names.begin());
}

// 0, 1, 2.. or 1, 2, 3..: columns that are numbered, not measured.
bool first_row_counts(const Grid& grid) {
  for (std::size_t c = 0; c < grid.columns; ++c) {
    if (grid.at(0, c) != grid.at(0, 0) + static_cast<double>(c)) return false;
  }
  return grid.columns > 1 && (grid.at(0, 0) == 0.0 || grid.at(0, 0) == 1.0);
}

// Its name says so, or it counts the rows.
bool first_column_is_index(const Grid& grid) {
  if (!grid.names.empty()) {
    const std::string& name = grid.names[0];
    return name.empty() || name == "id" || name == "index" || name == "idx" || name == "no" || name == "nr" || name.starts_with("unnamed");
  }
  for (std::size_t r = 0; r < grid.rows; ++r) {
    if (grid.at(r, 0) != grid.at(0, 0) + static_cast<double>(r)) return false;
  }
  return grid.rows >= kFewestCounted && (grid.at(0, 0) == 0.0 || grid.at(0, 0) == 1.0);
}

/// How a table writes levels.
struct Spelling {
  double above = 0.0;                                                ///< added to a number to have dBm
  double not_heard = std::numeric_limits<double>::quiet_NaN();       ///< besides numbers that are no levels
  bool zero_heard = true;                                            ///< 0 dBm is a level
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
    negative = negative || value < kFaintest_dB;
    if (value <= kHardlyHeard_dbm) ++low[value];
  }
  if (!negative && zeros > 0 && other_than_100 > zeros) return {-100.0, -100.0};
  Spelling spelling;
  const auto commonest = std::ranges::max_element(low, {}, [](const auto& entry) { return entry.second; });
  if (commonest != low.end()) {
    const std::size_t least = commonest->first <= kNoRadioReports_dbm ? (numbers + 9) / 10 : levels.values.size() / 2 + 1;
    if (commonest->second >= least) spelling.not_heard = commonest->first;
  }
  spelling.zero_heard = !negative;
  return spelling;
}

Result<std::vector<TabledScan>> scans_of(const Grid& levels) {
  const Spelling spelling = spelling_of(levels);
  std::vector<TabledScan> scans(levels.rows);
  for (std::size_t r = 0; r < levels.rows; ++r) {
    for (std::size_t c = 0; c < levels.columns; ++c) {
      const double rss_dbm = levels.at(r, c) + spelling.above;
      if (!std::isfinite(rss_dbm) || rss_dbm > 0.0 || rss_dbm == spelling.not_heard || (rss_dbm == 0.0 && !spelling.zero_heard)) continue;
      if (rss_dbm < kLeast_dbm) {
        return Fault{FaultCode::kOutOfRange, levels.path,
                     "scan " + std::to_string(r + 1) + ", access point " + std::to_string(c + 1) + ": level outside -120..0 dBm and no sign for not heard"};
      }
      scans[r].heard.push_back({static_cast<std::uint16_t>(c), rss_dbm});
    }
  }
  return scans;
}

bool one_of(const std::string& name, std::initializer_list<const char*> words, const char* axis) {
  const std::string letter = axis;
  for (const char* after : {"_", "(", "["}) {
    if (name.starts_with(letter + after)) return true;
  }
  return name == letter || name == "coord_" + letter || name == "pos_" + letter || std::ranges::find(words, name) != words.end();
}

/// Which columns of a table of places hold what; as published: x, y, z.
struct PlaceColumns {
  std::size_t x = 0, y = 1;
  std::optional<std::size_t> z;
  bool geographic = false;  // longitude and latitude by name
};

PlaceColumns place_columns(const Grid& places) {
  PlaceColumns columns;
  std::optional<std::size_t> x, y, z;
  for (std::size_t c = 0; c < places.names.size(); ++c) {
    const std::string& name = places.names[c];
    if (!x && one_of(name, {"lon", "lng", "long", "longitude", "easting", "east"}, "x")) x = c;
    if (!y && one_of(name, {"lat", "latitude", "northing", "north"}, "y")) y = c;
    if (!z && (one_of(name, {"level", "storey", "story", "height", "altitude"}, "z") || name.starts_with("floor"))) z = c;
  }
  const bool named = x && y;
  if (named) columns = {*x, *y, z, places.names[*x].starts_with("lo") || places.names[*x] == "lng"};
  if (!columns.z && places.columns > 2 && columns.x != 2 && columns.y != 2) columns.z = 2;
  return columns;
}

bool in_degrees(const Grid& places, const PlaceColumns& columns) {
  if (!columns.geographic) return false;
  for (const std::size_t c : {columns.x, columns.y}) {
    double low = places.at(0, c), high = low;
    for (std::size_t r = 1; r < places.rows; ++r) low = std::min(low, places.at(r, c)), high = std::max(high, places.at(r, c));
    if (high - low > kDegreesMost || std::abs(low) > 180.0) return false;
  }
  return true;
}

/// One pair, floors still as the file's z.
struct Pair {
  FingerprintTable table;
  std::vector<double> z;
};

Result<Pair> read_pair(const LevelsFiles& files) {
  auto places = read_grid(files.places);
  if (!places) return places.fault();
  if (places->columns > kMostPlaceColumns && places->rows <= kMostPlaceColumns) *places = turned(*places);
  auto levels = read_grid(files.levels);
  if (!levels) return levels.fault();
  if (places->columns > kMostPlaceColumns && levels->columns <= kMostPlaceColumns)
    return Fault{FaultCode::kMalformed, files.places, "is no table of places: the file of levels comes first, then that of places"};
  if ((places->names.empty() ? places->columns > 3 : true) && first_column_is_index(*places)) drop_first_column(*places);
  if (places->columns < 2) return Fault{FaultCode::kMalformed, files.places, "x,y,z or x,y expected"};
  const bool levels_numbered = first_row_counts(*levels), places_numbered = first_row_counts(*places);
  if (levels->rows - levels_numbered == places->rows - places_numbered) {
    if (levels_numbered) drop_first_row(*levels);
    if (places_numbered) drop_first_row(*places);
  }
  if (levels->rows != places->rows && levels->columns == places->rows) *levels = turned(*levels);
  if (levels->rows != places->rows) {
    return Fault{FaultCode::kMalformed, files.levels, std::to_string(levels->rows) + " scans of " + std::to_string(levels->columns) +
                                                          " access points, but " + std::to_string(places->rows) + " places in " + files.places};
  }
  if (levels->columns > 1 && first_column_is_index(*levels)) drop_first_column(*levels);
  if (levels->columns > kMostAccessPoints) return Fault{FaultCode::kOutOfRange, files.levels, "more than 65535 access points"};
  auto scans = scans_of(*levels);
  if (!scans) return scans.fault();
  Pair pair{{levels->columns, *std::move(scans), std::move(levels->names)}, {}};
  const PlaceColumns columns = place_columns(*places);
  if (in_degrees(*places, columns)) return Fault{FaultCode::kOutOfRange, files.places, "holds longitude and latitude in degrees: metres expected"};
  for (std::size_t i = 0; i < places->rows; ++i) {
    const double x = places->at(i, columns.x), y = places->at(i, columns.y), z = columns.z ? places->at(i, *columns.z) : 0.0;
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
    if (!pairs.empty()) number_like(pairs.front().table, pair->table);  // other names, or none: by their order
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
  for (auto it = fs::recursive_directory_iterator(folder, fs::directory_options::follow_directory_symlink, error);
       !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    const std::string name = lower(it->path().filename().string()), kind = lower(it->path().extension().string());
    const bool passed_over = name.starts_with('.') || name == "__macosx";
    if (passed_over || it.depth() >= kDeepest) it.disable_recursion_pending();  // links may lead round
    if (passed_over || !any_in(name, {"rss"}) || (kind != ".csv" && kind != ".txt" && kind != ".dat")) continue;
    if (any_in(name, {"trn", "train", "tst", "test", "val"}) && it->is_regular_file()) names.push_back(it->path());
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
