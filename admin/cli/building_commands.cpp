#include "admin/cli/program.hpp"

namespace wayfuse::cli {

void add_building_commands(CLI::App& app, Program& program) {
  auto* building = app.add_subcommand("building", "Buildings and their floors")->require_subcommand(1);
  building->add_subcommand("list", "All buildings")->callback([&] {
    program.call = {"GET", "/v1/buildings", "", "buildings", {"id", "name", "pipeline", "survey_version"}};
  });
  auto* show = building->add_subcommand("show", "One building");
  show->add_option("ID", program.building)->required();
  show->callback([&] { program.call = {"GET", "/v1/buildings/" + program.building, "", "", {}}; });
  auto* create = building->add_subcommand("create", "Create a building from its JSON description (- = standard input)");
  create->add_option("FILE", program.file)->required();
  create->callback([&] { program.call = {"POST", "/v1/buildings", content_of(program.file), "", {}}; });
  auto* replace = building->add_subcommand("replace", "Replace a building's description");
  replace->add_option("ID", program.building)->required();
  replace->add_option("FILE", program.file)->required();
  replace->callback([&] { program.call = {"PUT", "/v1/buildings/" + program.building, content_of(program.file), "", {}}; });
}

}  // namespace wayfuse::cli
