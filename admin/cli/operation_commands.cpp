#include "admin/cli/explanation.hpp"
#include "admin/cli/program.hpp"

namespace wayfuse::cli {

void add_operation_commands(CLI::App& app, Program& program) {
  app.add_subcommand("status", "Whether the server is ready, and why not")->callback([&] {
    program.call = {"GET", "/readyz", "", "", {}};
  });
  app.add_subcommand("version", "The server's version")->callback([&] { program.call = {"GET", "/v1/version", "", "", {}}; });
  app.add_subcommand("metrics", "Prometheus metrics")->callback([&] { program.call = {"GET", "/metrics", "", "", {}, true}; });
  auto* sessions = app.add_subcommand("sessions", "Live sessions");
  auto* explain = sessions->add_subcommand("explain", "Why a session's newest position is where it is");
  explain->add_option("TRACKED", program.id, "The session's public name, as `wayfuse sessions` lists it")->required();
  explain->add_option("--building", program.building, "For a key of this building only; 0 = any")->default_val("0");
  sessions->callback([&program, explain] {
    const std::vector<std::string> columns = {"tracked", "building", "device_model", "pipeline", "connected", "applied_through"};
    program.call = {"GET", "/v1/sessions", "", "sessions", columns};
    if (!*explain) return;
    const std::string in = program.building == "0" ? "/v1" : building_path(program, "");
    program.call = {.method = "GET", .path = in + "/sessions/" + escaped(program.id) + "/explain", .show = explained};
  });
  app.add_subcommand("pipelines", "Pipeline presets")->callback([&] {
    program.call = {"GET", "/v1/pipelines", "", "pipelines", {"pipeline"}};
  });
  app.add_subcommand("parts", "Every pipeline part")->callback([&] {
    program.call = {"GET", "/v1/parts", "", "parts", {"role", "name", "summary"}};
  });
}

}  // namespace wayfuse::cli
