#include "admin/cli/program.hpp"

namespace wayfuse::cli {

void add_operation_commands(CLI::App& app, Program& program) {
  app.add_subcommand("status", "Whether the server is ready, and why not")->callback([&] {
    program.call = {"GET", "/readyz", "", "", {}};
  });
  app.add_subcommand("version", "The server's version")->callback([&] { program.call = {"GET", "/v1/version", "", "", {}}; });
  app.add_subcommand("metrics", "Prometheus metrics")->callback([&] { program.call = {"GET", "/metrics", "", "", {}, true}; });
  app.add_subcommand("sessions", "Live sessions")->callback([&] {
    program.call = {"GET", "/v1/sessions", "", "sessions", {"tracked", "building", "device_model", "pipeline", "connected", "applied_through"}};
  });
  app.add_subcommand("pipelines", "Pipeline presets")->callback([&] {
    program.call = {"GET", "/v1/pipelines", "", "pipelines", {"pipeline"}};
  });
  app.add_subcommand("parts", "Every pipeline part")->callback([&] {
    program.call = {"GET", "/v1/parts", "", "parts", {"role", "name", "summary"}};
  });
}

}  // namespace wayfuse::cli
