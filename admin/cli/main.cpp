// wayfuse: the operator's command line. Every command is one request to the admin API, or a few.

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "admin/cli/completion.hpp"
#include "admin/cli/doctor.hpp"
#include "admin/cli/program.hpp"

namespace {

using namespace wayfuse::cli;

CLI::App* add_doctor_command(CLI::App& app, DoctorSettings& settings) {
  auto* doctor = app.add_subcommand("doctor", "Find what is misconfigured on this machine and at the server, and how to mend it");
  doctor->add_option("--config", settings.config, "The server's configuration file")->capture_default_str();
  doctor->add_option("--wayfused", settings.wayfused, "The server's program")->capture_default_str();
  doctor->add_option("--user", settings.user, "As whom the server runs; root looks with that user's eyes")->capture_default_str();
  return doctor;
}

// `wayfuse complete -- WORD...`: what may stand where the last word stands; for the shell.
int complete(const CLI::App& app, int argc, char** argv) {
  const std::vector<std::string> words(argv + std::min(argc, 3), argv + argc);
  for (const std::string& word : completions(app, words)) std::cout << word << "\n";
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  Program program;
  CLI::App app("wayfuse: run a building's positioning from the command line");
  app.require_subcommand(1);
  app.fallthrough();  // --json and its like may stand anywhere
  app.add_option("--server", program.connection.server, "Base URL of wayfused")->envname("WAYFUSE_SERVER")->default_val("http://127.0.0.1:8420");
  app.add_option("--key", program.connection.key, "API key; better given as WAYFUSE_KEY")->envname("WAYFUSE_KEY");
  app.add_option("--authority", program.connection.authority, "PEM file with the certificate authority to trust")->envname("WAYFUSE_AUTHORITY")->check(CLI::ExistingFile);
  app.add_flag("--json", program.json, "Print the server's JSON as it came");
  add_building_commands(app, program);
  add_survey_commands(app, program);
  add_map_commands(app, program);
  add_key_commands(app, program);
  add_operation_commands(app, program);
  add_plan_commands(app, program);
  add_zone_commands(app, program);
  add_webhook_commands(app, program);
  add_data_commands(app, program);
  add_recording_commands(app, program);
  DoctorSettings settings;
  const CLI::App* doctor = add_doctor_command(app, settings);
  if (argc > 1 && std::string_view(argv[1]) == "complete") return complete(app, argc, argv);
  try {
    app.parse(argc, argv);
    if (*doctor) return report(examine(program.connection, settings), program.json);
    return program.run ? program.run() : perform(program, program.call);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::cerr << "wayfuse: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
