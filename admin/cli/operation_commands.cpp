#include <unistd.h>

#include <chrono>
#include <iostream>
#include <memory>
#include <thread>

#include "admin/cli/explanation.hpp"
#include "admin/cli/program.hpp"
#include "admin/cli/sessions_top.hpp"

namespace wayfuse::cli {
namespace {

struct Watch {
  double every_s = 2.0;
  unsigned times = 0;  // 0 = until interrupted
  std::size_t most = 40;
};

// Shows the sessions again and again; with --json each answer as a line.
int watch_sessions(const Program& program, const Watch& watch) {
  using Steady = std::chrono::steady_clock;
  std::string before;
  Steady::time_point asked_before;
  for (unsigned round = 0; watch.times == 0 || round < watch.times; ++round) {
    if (round > 0) std::this_thread::sleep_for(std::chrono::duration<double>(watch.every_s));
    const Steady::time_point asked = Steady::now();
    const auto reply = exchange(program.connection, "GET", "/v1/sessions", "", "application/json");
    if (!reply) throw std::runtime_error(reply.fault().cause);
    if (reply->status != 200) return refused(*reply);
    if (program.json) {
      std::cout << reply->body << std::endl;
    } else {
      if (isatty(STDOUT_FILENO)) std::cout << "\033[H\033[2J";
      std::cout << top_of(reply->body, before, std::chrono::duration<double>(asked - asked_before).count(), watch.most) << std::flush;
    }
    before = reply->body;
    asked_before = asked;
  }
  return EXIT_SUCCESS;
}

}  // namespace

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
  const auto watch = std::make_shared<Watch>();
  auto* top = sessions->add_subcommand("top", "Watch them: the least certain first, with samples a second");
  top->add_option("--every", watch->every_s, "Seconds between looks")->capture_default_str()->check(CLI::Range(0.2, 3600.0));
  top->add_option("--times", watch->times, "Looks; 0 = until interrupted")->capture_default_str();
  top->add_option("--most", watch->most, "Rows")->capture_default_str()->check(CLI::Range(1, 10'000));
  top->callback([&program, watch] { program.run = [&program, watch] { return watch_sessions(program, *watch); }; });
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
