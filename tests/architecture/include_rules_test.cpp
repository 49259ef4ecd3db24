#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

// Who may include whom. A room is a folder; a file belongs to the longest room that is a prefix of its path. The table is
// the architecture: a new arrow is a new row here, with its reason in the room's README.
namespace {

namespace fs = std::filesystem;
using Rooms = std::set<std::string>;

const std::map<std::string, Rooms>& allowed() {
  static const std::map<std::string, Rooms> table = {
      {"vocabulary", {}},
      {"wire", {"vocabulary"}},
      {"sdk/motion", {"vocabulary"}},
      {"sdk/client", {"vocabulary", "wire", "sdk/motion"}},
      {"sdk/c", {"vocabulary", "wire", "sdk/motion", "sdk/client"}},
      {"sdk/js", {"vocabulary", "sdk/motion"}},
      {"sdk/simulator", {"vocabulary", "wire", "sdk/motion", "sdk/client"}},
      {"db", {"vocabulary", "wire"}},
      {"admin", {"vocabulary", "wire", "db", "admin/plan"}},
      {"admin/cli", {"vocabulary", "wire", "sdk/client"}},  // it surveys: files of other people's phones, in the SDK's batches
      {"admin/plan", {"vocabulary"}},
      {"server/locating", {"vocabulary"}},
      {"server/tracking", {"vocabulary"}},
      {"server/pipeline", {"vocabulary", "proto/src/wire/tree.hpp", "server/locating", "server/tracking"}},
      {"server/buildings", {"vocabulary", "server/locating", "server/pipeline", "db", "wire"}},
      {"server/quality", {"vocabulary", "wire", "server/pipeline", "server/buildings", "db", "admin/map_control.hpp", "sdk/motion",
                          "sdk/include/wayfuse/sdk/recording.hpp"}},
      {"server/maps", {"vocabulary", "wire", "db", "admin/map_control.hpp", "server/pipeline", "server/buildings", "server/quality"}},
      {"server/sessions", {"vocabulary", "wire", "server/buildings", "server/pipeline", "db", "admin/server_control.hpp",
                           "admin/session_control.hpp", "admin/zone_control.hpp", "admin/recording_control.hpp"}},
      {"server/recordings", {"vocabulary", "wire", "db", "admin/recording_control.hpp", "admin/http.hpp", "server/pipeline", "server/buildings", "server/sessions",
                             "sdk/include/wayfuse/sdk/recording.hpp"}},
      {"server/zones", {"vocabulary", "wire", "db", "admin/zone_control.hpp", "admin/plan/planar.hpp"}},
      {"server/webhooks", {"vocabulary", "wire", "db", "admin/webhook_control.hpp", "admin/zone_control.hpp"}},
      {"server/net", {"vocabulary", "wire", "server/sessions", "admin/router.hpp", "admin/http.hpp"}},
      {"server", {"vocabulary", "wire", "db", "admin", "server/pipeline", "server/buildings", "server/quality",
                  "server/sessions", "server/zones", "server/webhooks", "server/maps", "server/recordings", "server/net"}},
  };
  return table;
}

// Outside libraries a room may name, and where (suffix of the file).
bool library_allowed(const std::string& room, const fs::path& file, const std::string& include) {
  const std::string name = file.filename().string();
  const bool source = file.extension() == ".cpp";
  const auto starts = [&](const char* prefix) { return include.rfind(prefix, 0) == 0; };
  if (starts("boost/")) {
    const bool link = name.rfind("websocket_link", 0) == 0 && file.generic_string().rfind("sdk/src/", 0) == 0;
    return room == "server/net" || room == "server" || (room == "sdk/client" && link);
  }
  if (starts("nlohmann/")) return source && room != "vocabulary" && room != "wire" && room != "sdk/motion" && room != "server/tracking";
  if (starts("simdjson")) return false;  // tests only, as a peer
  if (starts("sqlite3")) return source && room == "db";
  if (starts("geos")) return source && room == "admin/plan";
  if (starts("archive")) return source && (room == "admin/plan" || room == "admin");
  if (starts("Eigen/")) return room == "server/locating" || room == "server/tracking" || (source && room == "sdk/motion");
  return true;
}

std::string room_of(const std::string& path) {
  if (path.rfind("proto/", 0) == 0) {
    const std::string name = fs::path(path).stem().string();
    return name == "codec" || name == "message" || path.find("proto/src/wire") == 0 ? "wire" : "vocabulary";
  }
  if (path.rfind("sdk/include/wayfuse/sdk/", 0) == 0) {
    static const Rooms motion = {"marg", "heading_estimator", "step_detector", "motion_tracker"};
    const fs::path file(path);
    if (file.extension() == ".h") return "sdk/c";
    return motion.count(file.stem().string()) ? "sdk/motion" : "sdk/client";
  }
  if (path.rfind("sdk/src/attitude/", 0) == 0 || path.rfind("sdk/src/walking/", 0) == 0) return "sdk/motion";
  if (path.rfind("sdk/src/c/", 0) == 0) return "sdk/c";
  if (path.rfind("sdk/src/js/", 0) == 0) return "sdk/js";
  if (path.rfind("sdk/src/simulator/", 0) == 0) return "sdk/simulator";
  if (path.rfind("sdk/", 0) == 0) return "sdk/client";
  std::string best;
  for (const auto& [room, _] : allowed()) {
    if (path.rfind(room + "/", 0) == 0 && room.size() > best.size()) best = room;
  }
  return best;
}

struct Include {
  fs::path file;      // relative to the source tree
  std::string target;
  bool quoted;
};

std::vector<Include> all_includes() {
  std::vector<Include> found;
  const fs::path root = WAYFUSE_SOURCE_DIR;
  const std::regex line_pattern(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  for (const char* top : {"proto", "sdk", "db", "admin", "server"}) {
    for (auto it = fs::recursive_directory_iterator(root / top); it != fs::recursive_directory_iterator(); ++it) {
      if (it->path().filename() == "node_modules") {
        it.disable_recursion_pending();
        continue;
      }
      const auto extension = it->path().extension();
      if (extension != ".hpp" && extension != ".cpp" && extension != ".h") continue;
      std::ifstream in(it->path());
      for (std::string line; std::getline(in, line);) {
        std::smatch match;
        if (std::regex_search(line, match, line_pattern)) {
          found.push_back({fs::relative(it->path(), root), match[2], match[1] == "\""});
        }
      }
    }
  }
  return found;
}

// The path, from the source tree, that a quoted include means.
std::string resolve(const Include& include) {
  const fs::path root = WAYFUSE_SOURCE_DIR;
  for (const char* base : {"", "proto/include/", "sdk/include/"}) {
    if (fs::exists(root / (base + include.target))) return base + include.target;
  }
  return "";
}

TEST(IncludeRules, ArrowsRunOneWay) {
  std::size_t seen = 0;
  for (const Include& include : all_includes()) {
    if (!include.quoted) continue;
    const std::string target = resolve(include);
    ASSERT_FALSE(target.empty()) << include.file << " includes \"" << include.target
                                 << "\": write the path from the source tree or an installed header";
    const std::string from = room_of(include.file.generic_string());
    const std::string to = room_of(target);
    ASSERT_FALSE(from.empty()) << include.file << " stands in no room";
    ++seen;
    if (from == to) continue;
    const Rooms& may = allowed().at(from);
    EXPECT_TRUE(may.count(to) || may.count(target)) << include.file << " (" << from << ") includes " << target << " (" << to << ")";
  }
  EXPECT_GT(seen, 30u);
}

TEST(IncludeRules, OutsideLibrariesStayInTheirRooms) {
  for (const Include& include : all_includes()) {
    if (include.quoted) continue;
    EXPECT_TRUE(library_allowed(room_of(include.file.generic_string()), include.file, include.target))
        << include.file << " includes <" << include.target << ">";
  }
}

TEST(IncludeRules, NoFolderIsADrawerForEverything) {
  const fs::path root = WAYFUSE_SOURCE_DIR;
  const std::regex drawer(R"(utils?|common|helpers?|misc|base|impl)");
  for (const char* top : {"proto", "sdk", "db", "admin", "server", "tests"}) {
    for (auto it = fs::recursive_directory_iterator(root / top); it != fs::recursive_directory_iterator(); ++it) {
      if (it->path().filename() == "node_modules") {
        it.disable_recursion_pending();
        continue;
      }
      EXPECT_FALSE(std::regex_match(it->path().stem().string(), drawer)) << it->path();
    }
  }
}

}  // namespace
