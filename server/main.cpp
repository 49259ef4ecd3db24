// wayfused: reads its configuration, serves, and leaves in good order at SIGTERM.
#include <csignal>
#include <cstdio>

#include "server/app.hpp"

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

}  // namespace

int main(int argc, char** argv) {
  const sigset_t signals = awaited_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // inherited by every thread; this one waits for them
  std::signal(SIGPIPE, SIG_IGN);
  auto line = wayfuse::read_command_line({argv, static_cast<std::size_t>(argc)}, environ);
  if (!line) return complain(line.fault(), 2);
  if (line->help) return std::fputs(wayfuse::help_text().c_str(), stdout) < 0;
  if (line->version) return std::puts("wayfused " WAYFUSE_VERSION) < 0;
  if (line->check_only) return std::puts("the configuration is good") < 0;

  auto app = wayfuse::App::start(std::move(line->config));
  if (!app) return complain(app.fault(), 1);
  announce(**app);
  for (int signal = 0; sigwait(&signals, &signal) == 0;) {
    if (signal != SIGHUP) break;
    (*app)->reload();
  }
  (*app)->drain();
  return 0;
}
