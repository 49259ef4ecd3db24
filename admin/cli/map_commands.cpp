#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "admin/cli/program.hpp"
#include "admin/cli/table.hpp"

namespace wayfuse::cli {
namespace {

using Json = nlohmann::ordered_json;

struct MapOptions {
  std::string version, reason, pipeline, expected_live;
  bool override_gate = false;
  std::string floor = "0", bssid, trust;
};

/// Asks and shows the answer with `show`, or as it came with --json.
int ask(const Program& program, const Call& call, const std::function<void(const Json&)>& show) {
  const auto reply = exchange(program.connection, call.method, call.path, call.body);
  if (!reply) {
    std::cerr << "wayfuse: " << reply.fault().cause << "\n";
    return EXIT_FAILURE;
  }
  if (reply->status >= 400) return refused(*reply);
  const Json json = Json::parse(reply->body, nullptr, false);
  if (program.json || !json.is_object()) {
    std::cout << reply->body << "\n";
  } else {
    show(json);
  }
  return EXIT_SUCCESS;
}

std::string text_of(const Json& json, const char* name, const char* form = "%.2f") {
  const auto found = json.is_object() ? json.find(name) : json.end();
  if (!json.is_object() || found == json.end() || found->is_null()) return "-";
  if (!found->is_number_float()) return found->is_string() ? found->get<std::string>() : found->dump();
  char text[40];
  std::snprintf(text, sizeof text, form, found->get<double>());
  return text;
}

std::vector<std::string> quality_cells(const Json& quality) {
  std::vector<std::string> cells;
  for (const char* name : {"instants", "mean_m", "median_m", "p90_m"}) cells.push_back(text_of(quality, name));
  for (const char* name : {"floor_hit", "in68", "in95"}) cells.push_back(text_of(quality, name, "%.3f"));
  return cells;
}

std::vector<std::string> row(std::vector<std::string> cells, const Json& quality) {
  for (std::string& cell : quality_cells(quality)) cells.push_back(std::move(cell));
  return cells;
}

void show_maps(const Json& maps) {
  std::vector<std::vector<std::string>> rows;
  for (const Json& map : maps["items"]) {
    rows.push_back(row({text_of(map, "version"), map.value("live", false) ? "live" : "", text_of(map, "survey_version"), text_of(map, "points"),
                        text_of(map, "sha256").substr(0, 12)},
                       map["quality"]));
  }
  std::cout << table({"version", "", "survey", "points", "sha256", "instants", "mean_m", "median_m", "p90_m", "floor_hit", "in68", "in95"}, rows);
}

/// The version, how well it did, and of each phone model that surveyed what the map takes out of its readings.
void show_map(const Json& map) {
  std::vector<std::vector<std::string>> rows;
  for (const Json& device : map["devices"]) {
    rows.push_back({text_of(device, "model"), text_of(device, "points"), text_of(device, "standing"), text_of(device, "offset_db", "%+.1f"),
                    text_of(device, "places"), text_of(device, "transmitters")});
  }
  std::cout << "version " << text_of(map, "version") << (map.value("live", false) ? " (live)" : "") << ", survey " << text_of(map, "survey_version")
            << ", " << text_of(map, "points") << " points, sha256 " << text_of(map, "sha256") << "\n\n"
            << table({"instants", "mean_m", "median_m", "p90_m", "floor_hit", "in68", "in95"}, {quality_cells(map["quality"])}) << "\n"
            << table({"device", "points", "standing", "offset_db", "places", "transmitters"}, rows);
}

void show_comparison(const Json& comparison) {
  std::cout << "version " << text_of(comparison, "version") << " against " << text_of(comparison, "live") << " (live): "
            << text_of(comparison, "verdict") << "\n";
  for (const char* list : {"reasons", "remarks"}) {
    for (const Json& line : comparison[list]) std::cout << "  " << line.get<std::string>() << "\n";
  }
  std::vector<std::vector<std::string>> rows;
  rows.push_back(row({"all", "candidate"}, comparison["candidate_quality"]));
  rows.push_back(row({"", "live"}, comparison["live_quality"]));
  for (const Json& walk : comparison["walks"]) {
    rows.push_back(row({text_of(walk, "name"), "candidate"}, walk["candidate"]));
    rows.push_back(row({"", "live"}, walk["live"]));
  }
  std::cout << table({"walk", "map", "instants", "mean_m", "median_m", "p90_m", "floor_hit", "in68", "in95"}, rows);
}

/// The floor as text, one letter a cell or block of cells: metres of expected error, + from 10, . where phones cannot be.
void draw(const Json& accuracy) {
  const std::size_t columns = accuracy["columns"], rows = accuracy["rows"], block = columns / 100 + 1;
  for (std::size_t top = rows; top > 0; top -= std::min(top, block)) {
    std::string line;
    for (std::size_t column = 0; column < columns; column += block) {
      const Json& cell = accuracy["expected_m"][(top - 1) * columns + column];
      const double expected_m = cell.is_number() ? cell.get<double>() : -1.0;
      line += expected_m < 0.0 ? '.' : expected_m >= 9.5 ? '+' : static_cast<char>('0' + static_cast<int>(expected_m + 0.5));
    }
    std::cout << line << "\n";
  }
}

void show_accuracy(const Json& accuracy) {
  draw(accuracy);
  std::cout << "median error to expect " << text_of(accuracy, "median_m") << " m; cells of " << text_of(accuracy, "cell_m") << " m, north up\n"
            << text_of(accuracy, "basis") << "\n";
}

void show_plan(const Json& plan) {
  std::cout << "median error to expect now: " << text_of(plan, "median_now_m") << " m\n";
  if (plan["walks"].empty()) std::cout << "nothing left to walk that is worth it\n";
  std::size_t number = 0;
  for (const Json& walk : plan["walks"]) {
    const std::string way = walk["path"].size() > 1 ? "walk " + text_of(walk, "length_m", "%.0f") + " m" : "scan at one point";
    std::cout << ++number << ". " << way << ", then " << text_of(walk, "median_after_m") << " m: " << text_of(walk, "why") << "\n   ";
    for (const Json& point : walk["path"]) std::printf(" (%.0f, %.0f)", point[0].get<double>(), point[1].get<double>());
    std::fflush(stdout);
    std::cout << "\n";
  }
}

CLI::App* on_building(CLI::App& group, Program& program, const char* name, const char* what) {
  auto* command = group.add_subcommand(name, what);
  command->add_option("BUILDING", program.building)->required();
  return command;
}

std::string promotion_body(const MapOptions& options) {
  Json body{{"reason", options.reason}, {"override", options.override_gate}};
  if (!options.expected_live.empty()) body["expected_live"] = std::stoull(options.expected_live);
  return body.dump();
}

void add_version_commands(CLI::App& app, Program& program, MapOptions& options) {
  auto* map = app.add_subcommand("map", "Radio maps as versions")->require_subcommand(1);
  const auto at = [&program, &options](const char* what) { return building_path(program, "/maps/" + escaped(options.version) + what); };
  const auto on_version = [&](const char* name, const char* what) {
    auto* command = on_building(*map, program, name, what);
    command->add_option("VERSION", options.version)->required();
    return command;
  };
  on_building(*map, program, "list", "All versions, with their measured quality")->callback([&program] {
    program.run = [&program] { return ask(program, {"GET", building_path(program, "/maps?most=1000")}, show_maps); };
  });
  on_building(*map, program, "history", "Which version was put in force when, by whom and why")->callback([&program] {
    program.call = {"GET", building_path(program, "/maps/publications?most=1000"), "", "items", {"id", "version", "act", "at_us", "by_key", "reason"}};
  });
  on_building(*map, program, "build", "Build a version from the survey as it stands and replay the quality walks on it")->callback([&program] {
    program.call = {"POST", building_path(program, "/maps")};
  });
  on_version("show", "One version: quality, and the phone models that surveyed with what is taken out of their readings")->callback([&program, at] {
    program.run = [&program, path = at("")] { return ask(program, {"GET", path}, show_map); };
  });
  auto* compare = on_version("compare", "A version against the live one, walk by walk");
  compare->add_option("--pipeline", options.pipeline, "Replay with this preset instead of the building's own");
  compare->callback([&program, &options, at] {
    const std::string path = at("/comparison") + (options.pipeline.empty() ? "" : "?pipeline=" + escaped(options.pipeline));
    program.run = [&program, path] { return ask(program, {"GET", path}, show_comparison); };
  });
  auto* promote = on_version("promote", "Put a version in force; refused when it is worse than the live one");
  promote->add_option("--reason", options.reason, "Kept with the publication");
  promote->add_option("--expected-live", options.expected_live, "Only while this version is live");
  promote->add_flag("--override", options.override_gate, "Although it is worse; needs --reason");
  promote->callback([&program, &options, at] { program.call = {"POST", at("/promotion"), promotion_body(options)}; });
  auto* rollback = on_building(*map, program, "rollback", "Back to what was in force before");
  rollback->add_option("--reason", options.reason, "Kept with the publication");
  rollback->callback([&program, &options] {
    program.call = {"POST", building_path(program, "/maps/rollback"), Json{{"reason", options.reason}}.dump()};
  });
}

void add_walk_commands(CLI::App& app, Program& program) {
  auto* walks = app.add_subcommand("quality-walk", "Recorded walks with their truth, that maps are measured by")->require_subcommand(1);
  auto* add = on_building(*walks, program, "add", "Add a recording (sdk/README.md) or survey_walk documents, one a line; - = standard input");
  add->add_option("FILE", program.file)->required();
  add->add_option("--name", program.name, "For people; the hash of the recording if not said");
  add->callback([&program] {
    const std::string query = program.name.empty() ? "" : "?name=" + escaped(program.name);
    program.call = {"POST", building_path(program, "/quality-walks" + query), content_of(program.file)};
  });
  on_building(*walks, program, "list", "All quality walks")->callback([&program] {
    program.call = {"GET", building_path(program, "/quality-walks?most=1000"), "", "items", {"id", "name", "device_model", "recorded_at_us", "bytes"}};
  });
  auto* remove = on_building(*walks, program, "remove", "Remove a walk and what was measured by it");
  remove->add_option("ID", program.id)->required();
  remove->callback([&program] { program.call = {"DELETE", building_path(program, "/quality-walks/" + escaped(program.id))}; });
}

void add_survey_quality_commands(CLI::App& app, Program& program, MapOptions& options) {
  auto* survey = app.get_subcommand("survey");
  const auto on_floor = [&](const char* name, const char* what, const char* path, void (*show)(const Json&)) {
    auto* command = on_building(*survey, program, name, what);
    command->add_option("--floor", options.floor, "Ordinal; 0 = ground")->default_val("0");
    command->callback([&program, &options, path, show] {
      const std::string at = building_path(program, std::string(path) + "?floor=" + escaped(options.floor));
      program.run = [&program, at, show] { return ask(program, {"GET", at}, show); };
    });
  };
  on_floor("accuracy", "Coverage and the error to expect where, from the survey alone", "/accuracy", show_accuracy);
  on_floor("plan", "What to walk next, and what it is worth", "/survey-plan", show_plan);
}

void add_access_point_commands(CLI::App& app, Program& program, MapOptions& options) {
  auto* points = app.add_subcommand("ap", "Access points as live traffic hears them, against the survey")->require_subcommand(1);
  on_building(*points, program, "list", "All that anything is known of")->callback([&program] {
    program.call = {"GET", building_path(program, "/access-points"), "", "items",
                    {"bssid", "state", "quarantined", "trust", "heard_sessions", "distance_m", "change_db", "reason"}};
  });
  auto* trust = on_building(*points, program, "trust", "Believe the traffic about it (auto), or use it always or never");
  trust->add_option("BSSID", options.bssid)->required();
  trust->add_option("TRUST", options.trust)->required()->check(CLI::IsMember({"auto", "always", "never"}));
  trust->callback([&program, &options] {
    program.call = {"PUT", building_path(program, "/access-points/" + escaped(options.bssid)), Json{{"trust", options.trust}}.dump()};
  });
}

}  // namespace

void add_map_commands(CLI::App& app, Program& program) {
  static MapOptions options;  // lives as long as the callbacks that read it
  add_version_commands(app, program, options);
  add_walk_commands(app, program);
  add_survey_quality_commands(app, program, options);
  add_access_point_commands(app, program, options);
}

}  // namespace wayfuse::cli
