#include "tests/evaluation/datasets/uji_collection.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

#include "tests/evaluation/datasets/floor_map.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

constexpr double kMercatorLeast = 1e5;  // a site's own frame ends before
constexpr double kDegreesMost = 0.5;    // a site's extent
constexpr double kAsUji = 0.002;

std::vector<fs::path> sorted_entries(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> entries;
  for (auto it = fs::directory_iterator(folder, error); !error && it != fs::directory_iterator(); it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!name.starts_with('.') && name != "__MACOSX") entries.push_back(it->path());
  }
  std::ranges::sort(entries);
  return entries;
}

std::optional<UjiFiles> pair_in(const fs::path& folder) {
  std::optional<fs::path> training, validation;
  for (const fs::path& entry : sorted_entries(folder)) {
    std::string name = entry.filename().string();
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (!training && name.ends_with("trainingdata.csv")) training = entry;
    if (!validation && name.ends_with("validationdata.csv")) validation = entry;
  }
  if (!training || !validation) return std::nullopt;
  return UjiFiles{training->string(), validation->string()};
}

}  // namespace

std::optional<UjiFiles> find_uji(const std::string& folder) {
  if (auto here = pair_in(folder)) return here;
  for (const fs::path& entry : sorted_entries(folder)) {
    if (auto below = pair_in(entry)) return below;
  }
  return std::nullopt;
}

Result<double> metres_per_unit(const FingerprintTable& table, const std::string& file) {
  if (table.scans.empty()) return Fault{FaultCode::kMalformed, file, "holds no scan"};
  BuildingPoint low = table.scans.front().point, high = low;
  for (const TabledScan& scan : table.scans) {
    low = {std::min(low.x_m, scan.point.x_m), std::min(low.y_m, scan.point.y_m)};
    high = {std::max(high.x_m, scan.point.x_m), std::max(high.y_m, scan.point.y_m)};
  }
  const double farthest = std::max({std::abs(low.x_m), std::abs(high.x_m), std::abs(low.y_m), std::abs(high.y_m)});
  if (farthest > kMercatorLeast) {
    const double scale = std::cos(to_geo({low.x_m, 0.5 * (low.y_m + high.y_m)}).latitude_deg * std::numbers::pi / 180.0);
    return std::abs(scale - kUjiMetresPerUnit) < kAsUji ? kUjiMetresPerUnit : scale;
  }
  const double extent = std::max(high.x_m - low.x_m, high.y_m - low.y_m);
  if (extent > 0.0 && extent < kDegreesMost && farthest <= 180.0)
    return Fault{FaultCode::kOutOfRange, file, "LONGITUDE and LATITUDE are degrees: metres, or units of the Web-Mercator plane, expected"};
  return 1.0;
}

}  // namespace wayfuse
