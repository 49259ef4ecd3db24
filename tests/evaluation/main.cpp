#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <vector>

#include "tests/evaluation/commands.hpp"

// wayfuse-eval: how accurate it is, on recorded data and on the papers' own experiments.
int main(int argc, char** argv) {
  CLI::App app("Measures wayfuse on recorded data; every figure in the documentation comes from here.", "wayfuse-eval");
  app.require_subcommand(1);
  app.get_formatter()->column_width(36);
  std::function<int()> chosen;
  for (const wayfuse::AddCommand add : wayfuse::evaluation_commands()) add(app, chosen);
  CLI11_PARSE(app, argc, argv);
  try {
    return chosen();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "wayfuse-eval: %s\n", error.what());
    return 1;
  }
}
