#include "admin/cli/program.hpp"

namespace wayfuse::cli {

void add_survey_commands(CLI::App& app, Program& program) {
  auto* survey = app.add_subcommand("survey", "Reference points and access points")->require_subcommand(1);
  const auto at = [&](const char* what) { return "/v1/buildings/" + program.building + what; };
  auto* upload = survey->add_subcommand("upload", "Upload a survey document (proto/README.md), - = standard input");
  upload->add_option("BUILDING", program.building)->required();
  upload->add_option("FILE", program.file)->required();
  upload->callback([&program, at] { program.call = {"POST", at("/points"), content_of(program.file), "", {}}; });
  auto* dump = survey->add_subcommand("export", "Every reference point, to standard output");
  dump->add_option("BUILDING", program.building)->required();
  dump->add_option("--format", program.format, "csv or geojson")->check(CLI::IsMember({"csv", "geojson"}));
  dump->callback([&program, at] { program.call = {"GET", at(("/points." + program.format).c_str()), "", "", {}, true}; });
  auto* transmitters = survey->add_subcommand("transmitters", "Access points as the survey heard them");
  transmitters->add_option("BUILDING", program.building)->required();
  transmitters->callback([&program, at] {
    program.call = {"GET", at("/transmitters"), "", "transmitters", {"bssid", "frequency_mhz", "readings", "strongest_dbm"}};
  });
}

}  // namespace wayfuse::cli
