#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "admin/cli/program.hpp"
#include "admin/cli/table.hpp"

namespace wayfuse::cli {
namespace {

using nlohmann::json;

// What was found, errors first, then the floors: what an operator looks at before storing.
void show_checks(const json& report) {
  for (const json& check : report.value("checks", json::array())) {
    const std::string feature = check.value("feature", "");
    std::cout << check.value("severity", "") << ": " << (feature.empty() ? "" : feature + ": ") << check.value("detail", "") << " [" << check.value("code", "")
              << "]\n";
  }
}

std::string number(const json& entry, const char* field, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, entry.value(field, 0.0));
  return text;
}

// A report as it came, or its checks and then what `the_rest` prints of it. An import with errors is a failure either way.
int show(const Program& program, const Reply& reply, void (*the_rest)(const json& report, const Reply& reply)) {
  const json report = json::parse(reply.body, nullptr, false);
  if (!report.is_object() || !report.contains("checks")) return refused(reply);
  if (program.json) {
    std::cout << reply.body << "\n";
  } else {
    show_checks(report);
    the_rest(report, reply);
  }
  return reply.status >= 400 ? EXIT_FAILURE : EXIT_SUCCESS;
}

void show_floors(const json& report, const Reply& reply) {
  std::vector<std::vector<std::string>> rows;
  for (const json& floor : report["floors"]) {
    rows.push_back({floor["ordinal"].dump(), floor.value("label", ""), number(floor, "outline_m2", 0), number(floor, "walkable_m2", 0), floor["rooms"].dump(),
                    floor["doors"].dump(), floor["walls"].dump()});
  }
  std::cout << table({"floor", "label", "outline_m2", "walkable_m2", "rooms", "doors", "walls"}, rows);
  std::cout << (report.value("stored", false) ? "stored" : reply.status >= 400 ? "not stored: mend the errors above" : "not stored: a dry run") << "\n";
}

void show_fit(const json& report, const Reply&) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < report["control_points"].size(); ++i) {
    const json& point = report["control_points"][i];
    rows.push_back({std::to_string(i), number(point, "residual_m", 2), point["without_it_m"].is_null() ? "-" : number(point, "without_it_m", 2)});
  }
  std::cout << table({"point", "residual_m", "without_it_m"}, rows);
  std::cout << "rms " << number(report, "rms_m", 2) << " m, scale " << number(report, "scale", 4) << ", "
            << (report.value("stored", false) ? "stored" : "not stored") << "\n";
}

int send(const Program& program, const Call& call, void (*the_rest)(const json& report, const Reply& reply)) {
  const auto reply = exchange(program.connection, call.method, call.path, call.body, call.content_type);
  if (!reply) {
    std::cerr << "wayfuse: " << reply.fault().cause << "\n";
    return EXIT_FAILURE;
  }
  return show(program, *reply, the_rest);
}

struct PlanChoice {
  std::string floor, label, coordinates, rooms;
  bool dry_run = false;
  bool zones = false;
};

std::string query_of(const PlanChoice& choice) {
  std::string query;
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) query += (query.empty() ? "?" : "&") + std::string(name) + "=" + escaped(value);
  };
  add("floor", choice.floor);
  add("label", choice.label);
  add("coordinates", choice.coordinates);
  add("rooms", choice.rooms);
  add("dry_run", choice.dry_run ? "1" : "");
  add("zones", choice.zones ? "1" : "");
  return query;
}

}  // namespace

void add_plan_commands(CLI::App& app, Program& program) {
  auto* plan = app.add_subcommand("plan", "Floor plans: GeoJSON, IMDF archives, images")->require_subcommand(1);
  auto* import = plan->add_subcommand("import", "Read floors from a GeoJSON file or an IMDF archive, with checks");
  auto choice = std::make_shared<PlanChoice>();
  import->add_option("BUILDING", program.building)->required();
  import->add_option("FILE", program.file)->required();
  import->add_option("--floor", choice->floor, "Ordinal of the floor the file holds, where it does not say");
  import->add_option("--label", choice->label, "That floor's label");
  import->add_option("--coordinates", choice->coordinates, "wgs84, mercator or local; guessed where not said")->check(CLI::IsMember({"wgs84", "mercator", "local"}));
  import->add_option("--rooms", choice->rooms, "closed, or walkable where phones are tracked into rooms")->check(CLI::IsMember({"closed", "walkable"}));
  import->add_flag("--dry-run", choice->dry_run, "Only check");
  import->add_flag("--zones", choice->zones, "Make a zone of each room with a name");
  import->callback([&, choice] {
    program.run = [&program, choice] {
      return send(program, {"PUT", building_path(program, "/plan" + query_of(*choice)), content_of(program.file), "", {}, false, "application/octet-stream"}, show_floors);
    };
  });

  auto* image = plan->add_subcommand("image", "Put a floor's picture, over its outline or where it is told");
  auto placement = std::make_shared<std::map<std::string, std::string>>();
  image->add_option("BUILDING", program.building)->required();
  image->add_option("FLOOR", program.id, "Ordinal")->required();
  image->add_option("FILE", program.file, "PNG or JPEG")->required();
  for (const char* name : {"width_m", "height_m", "origin_x_m", "origin_y_m", "azimuth_deg"}) {
    std::string flag = std::string("--") + name;
    std::replace(flag.begin() + 2, flag.end(), '_', '-');
    image->add_option_function<std::string>(flag, [placement, name](const std::string& value) { (*placement)[name] = value; });
  }
  image->callback([&, placement] {
    std::string query;
    for (const auto& [name, value] : *placement) query += (query.empty() ? "?" : "&") + name + "=" + escaped(value);
    program.call = {"PUT", building_path(program, "/floors/" + escaped(program.id) + "/image" + query), content_of(program.file), "", {}, false, "application/octet-stream"};
  });

  auto* georeference = app.get_subcommand("building")->add_subcommand("georeference", "Lay a building on the earth by control points (JSON: control_points)");
  auto dry_run = std::make_shared<bool>(false);
  georeference->add_option("BUILDING", program.building)->required();
  georeference->add_option("FILE", program.file)->required();
  georeference->add_flag("--dry-run", *dry_run, "Only fit and check");
  georeference->callback([&, dry_run] {
    program.run = [&program, dry_run] {
      return send(program, {"PUT", building_path(program, std::string("/georeference") + (*dry_run ? "?dry_run=1" : "")), content_of(program.file)}, show_fit);
    };
  });
}

}  // namespace wayfuse::cli
