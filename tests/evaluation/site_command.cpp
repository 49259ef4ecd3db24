#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>

#include "tests/evaluation/commands.hpp"
#include "tests/evaluation/datasets/recorded_site.hpp"
#include "tests/evaluation/datasets/split.hpp"

namespace wayfuse {
namespace {

struct SiteOptions {
  std::string data;
  std::vector<std::string> floors;
};

struct FloorTally {
  int walks[3] = {0, 0, 0};  // by Split
  double seconds = 0.0;
  std::size_t scans = 0;
  std::size_t way_points = 0;
  std::size_t off_plan = 0;
};

int show_site(const SiteOptions& options) {
  const auto site = read_site(options.data, options.floors);
  if (!site) {
    std::fprintf(stderr, "wayfuse-eval site: %s\n", to_string(site.fault()).c_str());
    return 2;
  }
  std::map<FloorOrdinal, FloorTally> tallies;
  std::vector<std::string> complaints, notes = site->complaints;
  for (const WalkFile& file : site->walks) {
    const auto walk = read_walk(file.path, file.floor_origin);
    if (!walk) {
      complaints.push_back(to_string(walk.fault()));
      continue;
    }
    complaints.insert(complaints.end(), walk->complaints.begin(), walk->complaints.end());
    notes.insert(notes.end(), walk->notes.begin(), walk->notes.end());
    FloorTally& tally = tallies[file.floor];
    ++tally.walks[static_cast<int>(split_of(file.id))];
    tally.seconds += walk->duration_s();
    tally.scans += walk->scans.size();
    tally.way_points += walk->way_points.size();
    const Floor* floor = site->floor(file.floor);
    for (const TruePoint& point : walk->way_points) {
      tally.off_plan += !floor->walkable.empty() && !contains(floor->walkable.front(), point.point);
    }
  }
  std::printf("%s\n%-8s %7s  %7s %12s %6s  %8s %7s %11s %10s\n", site->name.c_str(), "floor", "ordinal", "survey",
              "development", "test", "minutes", "scans", "way points", "off plan");
  for (const Floor& floor : site->floors) {
    const FloorTally& tally = tallies[floor.ordinal];
    std::printf("%-8s %7d  %7d %12d %6d  %8.1f %7zu %11zu %10zu\n", floor.label.c_str(), floor.ordinal.value, tally.walks[0],
                tally.walks[1], tally.walks[2], tally.seconds / 60.0, tally.scans, tally.way_points, tally.off_plan);
  }
  for (const std::string& note : notes) std::fprintf(stderr, "note: %s\n", note.c_str());
  for (const std::string& complaint : complaints) std::fprintf(stderr, "left out: %s\n", complaint.c_str());
  return 0;
}

}  // namespace

void add_site_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<SiteOptions>();
  CLI::App* command = app.add_subcommand("site", "What a site folder holds: floors, walks by split, lines that do not parse");
  add_site_options(*command, options->data, options->floors);
  command->callback([options, &chosen] { chosen = [options] { return show_site(*options); }; });
}

}  // namespace wayfuse
