// wayfused: reads its configuration, serves, and leaves in good order at SIGTERM.
#include <csignal>
#include <cstdio>

#include "server/app.hpp"
#include "server/checkup.hpp"
#include "server/service_notice.hpp"

namespace {

sigset_t awaited_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, signal);
  return signals;
}

int complain(const wayfuse::Fault& fault, int status) {
  std::fprintf(stderr, "wayfused: %s\n", wayfuse::to_string(fault).c_str());
  return status;
}

// One JSON object a line, for whoever started us.
void announce(const wayfuse::App& app) {
  if (!app.first_key().empty()) {
    std::printf("{\"event\":\"first_start\",\"admin_key\":\"%s\"}\n", app.first_key().c_str());
  }
  std::printf("{\"event\":\"ready\",\"url\":\"%s\",\"port\":%u,\"version\":\"%s\"}\n", app.url().c_str(), app.port(),
              WAYFUSE_VERSION);
  std::fflush(stdout);
}

int check(const wayfuse::CommandLine& line) {
  const auto findings = wayfuse::check_up(line.config);
  std::fputs((line.check_as_json ? to_json(findings) : to_text(findings)).c_str(), stdout);
  return wayfuse::serves(findings) ? 0 : 2;
}

void serve(wayfuse::App& app, const sigset_t& signals, std::span<const char* const> arguments) {
  wayfuse::tell_service_manager("READY=1");
  for (int signal = 0; sigwait(&signals, &signal) == 0 && signal == SIGHUP;) {
    wayfuse::tell_service_manager("RELOADING=1");
    const auto line = wayfuse::read_command_line(arguments, environ);
    line ? app.reload(line->config) : app.refuse_reload(line.fault());
    wayfuse::tell_service_manager("READY=1");
  }
  wayfuse::tell_service_manager("STOPPING=1");
  app.drain();
}

}  // namespace

int main(int argc, char** argv) {
  const sigset_t signals = awaited_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // inherited by every thread; this one waits for them
  std::signal(SIGPIPE, SIG_IGN);
  const std::span<const char* const> arguments(argv, static_cast<std::size_t>(argc));
  const auto line = wayfuse::read_command_line(arguments, environ);
  if (!line) return complain(line.fault(), 2);
  if (line->help) return std::fputs(wayfuse::help_text().c_str(), stdout) < 0;
  if (line->version) return std::puts("wayfused " WAYFUSE_VERSION) < 0;
  if (line->print_config) return std::fputs(wayfuse::toml_text(line->config).c_str(), stdout) < 0;
  if (line->check_only) return check(*line);

  auto app = wayfuse::App::start(line->config);
  if (!app) return complain(app.fault(), 1);
  announce(**app);
  serve(**app, signals, arguments);
  return 0;
}
