#include "tests/evaluation/datasets/recorded_site.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "tests/evaluation/datasets/floor_map.hpp"
#include "sdk/src/recording/import/text_line.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWalkFolder = "path_data_files";

std::vector<fs::path> sorted_entries(const fs::path& folder) {
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder)) entries.push_back(entry.path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<fs::path> floor_folders(const fs::path& folder) {
  if (fs::is_directory(folder / kWalkFolder)) return {folder};
  std::vector<fs::path> found;
  for (const fs::path& entry : sorted_entries(folder)) {
    if (fs::is_directory(entry / kWalkFolder)) found.push_back(entry);
  }
  return found;
}

// What may be a walk: not what systems and editors leave beside it.
bool is_walk_file(const fs::path& file) {
  return (file.extension() == ".txt" || file.extension() == ".TXT") && !file.filename().string().starts_with('.');
}

// Of some walks of a floor, in its own frame.
std::vector<BuildingPoint> some_way_points(const fs::path& floor) {
  constexpr std::size_t kWalks = 20;
  std::vector<BuildingPoint> points;
  std::size_t read = 0;
  for (const fs::path& file : sorted_entries(floor / kWalkFolder)) {
    if (!is_walk_file(file) || read == kWalks) continue;
    const auto walk = read_walk(file.string(), {});
    if (!walk) continue;
    ++read;
    for (const TruePoint& point : walk->way_points) points.push_back(point.point);
  }
  return points;
}

// A walk copied to a second floor was on one of them only, and would survey and be scored under one name.
void drop_doubled(RecordedSite& site) {
  std::vector<WalkFile> kept;
  for (WalkFile& file : site.walks) {
    if (!kept.empty() && kept.back().id == file.id)
      site.complaints.push_back(file.path + ": left out, another file has its name: " + kept.back().path);
    else
      kept.push_back(std::move(file));
  }
  site.walks = std::move(kept);
}

// The site itself, or the only site inside the folder given.
fs::path site_folder(const fs::path& folder) {
  if (!floor_folders(folder).empty()) return folder;
  std::vector<fs::path> sites;
  for (const fs::path& entry : sorted_entries(folder)) {
    if (fs::is_directory(entry) && !floor_folders(entry).empty()) sites.push_back(entry);
  }
  return sites.size() == 1 ? sites.front() : folder;
}

}  // namespace

const Floor* RecordedSite::floor(FloorOrdinal ordinal) const {
  const auto found = std::find_if(floors.begin(), floors.end(), [&](const Floor& f) { return f.ordinal == ordinal; });
  return found == floors.end() ? nullptr : &*found;
}

Result<RecordedSite> read_site(const std::string& folder, const std::vector<std::string>& only_floors) {
  if (!fs::is_directory(folder)) return Fault{FaultCode::kNotFound, folder, "is not a folder"};
  const fs::path root = site_folder(folder);
  const std::vector<fs::path> folders = floor_folders(root);
  if (folders.empty()) {
    return Fault{FaultCode::kNotFound, folder, "holds no <floor>/path_data_files: give the folder of one site"};
  }
  RecordedSite site;
  site.name = fs::path(root / "").parent_path().filename().string();
  std::vector<std::string> labels;
  for (const fs::path& floor : folders) labels.push_back(floor.filename().string());
  const std::vector<FloorOrdinal> ordinals = floor_ordinals(labels);
  for (const std::string& wanted : only_floors) {
    if (std::find(labels.begin(), labels.end(), wanted) == labels.end()) {
      std::string known;
      for (const std::string& label : labels) known += " " + label;
      return Fault{FaultCode::kNotFound, "floors", wanted + " is not a floor of this site; there are:" + known};
    }
  }

  std::vector<FloorMap> maps;
  for (std::size_t i = 0; i < folders.size(); ++i) {
    maps.push_back(read_floor_map(folders[i].string(), site.complaints, [&] { return some_way_points(folders[i]); }));
  }
  std::optional<std::size_t> nearest;  // to the ground, with a map: gives the frame
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (maps[i].corner && (!nearest || std::abs(ordinals[i].value) < std::abs(ordinals[*nearest].value))) nearest = i;
  }
  if (nearest) site.georeference = Georeference{maps[*nearest].corner_geo(), 0.0};

  for (std::size_t i = 0; i < folders.size(); ++i) {
    if (!only_floors.empty() && std::find(only_floors.begin(), only_floors.end(), labels[i]) == only_floors.end()) continue;
    BuildingPoint origin{0.0, 0.0};
    if (nearest && maps[i].corner) origin = maps[i].corner_seen_from(maps[*nearest]);
    Floor floor{ordinals[i], labels[i], maps[i].outline, {}};
    if (!maps[i].outline.rings.empty()) floor.walkable = {maps[i].walkable};
    move_by(floor, origin);
    site.floors.push_back(std::move(floor));
    for (const fs::path& file : sorted_entries(folders[i] / kWalkFolder)) {
      if (is_walk_file(file)) site.walks.push_back({file.stem().string(), file.string(), ordinals[i], origin});
    }
  }
  std::sort(site.floors.begin(), site.floors.end(), [](const Floor& a, const Floor& b) { return a.ordinal < b.ordinal; });
  std::stable_sort(site.walks.begin(), site.walks.end(), [](const WalkFile& a, const WalkFile& b) { return a.id < b.id; });
  drop_doubled(site);
  return site;
}

}  // namespace wayfuse
