// wayfuse-phone: stand-in phones that survey a simulated building and walk through it. The SDK's reference user.

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "sdk/src/simulator/fleet.hpp"
#include "sdk/src/simulator/stand_in_phone.hpp"

namespace {

using namespace wayfuse;
using namespace wayfuse::simulator;

struct WorldOptions {
  OfficeSettings office;
  std::uint64_t seed = 1;
  std::string pipeline = "default";

  void add_to(CLI::App& app) {
    app.add_option("--seed", seed, "Of the world and everything in it");
    app.add_option("--floors", office.floors, "Storeys of the office")->check(CLI::Range(1, 20));
    app.add_option("--length", office.length_m, "Of the office, metres")->check(CLI::Range(40.0, 200.0));
    app.add_option("--transmitters", office.transmitters_per_floor, "Access points a floor")->check(CLI::Range(1, 200));
  }
  World make() const {
    Random random(seed);
    World world = make_office(office, random);
    world.pipeline = pipeline;
    return world;
  }
};

void add_server_options(CLI::App& app, ServerAddress& server, BuildingId& building) {
  app.add_option("--server", server.url, "Like ws://127.0.0.1:8420/v1/session")->required();
  app.add_option("--key", server.key, "API key; better given as WAYFUSE_KEY")->envname("WAYFUSE_KEY")->required();
  app.add_option("--authority", server.authority, "PEM file with the certificate authority to trust")->check(CLI::ExistingFile);
  app.add_option("--building", building.value, "Building id on the server")->required();
}

int record(const World& world, std::uint64_t seed, double minutes, const std::string& file) {
  Random random(seed);
  const Propagation propagation(world, {});
  const Walker walker(world, {}, from_seconds(60 * minutes), {}, random);
  StandInSettings settings;
  settings.device = draw_device(random);
  StandInPhone phone(world, propagation, walker, settings, random.split());
  std::ofstream out(file);
  if (!out) {
    std::cerr << "wayfuse-phone: " << file << " cannot be written\n";
    return EXIT_FAILURE;
  }
  RecordingWriter writer(out, {settings.device.model, "wayfuse-phone", world.name, UnixTime{}});
  PhoneTime next_mark = phone.next_time();
  while (const auto event = phone.next()) {
    if (time_of(*event) >= next_mark) {
      writer.write(TruthMark{next_mark, phone.truth(next_mark).place});
      next_mark += std::chrono::seconds(1);
    }
    writer.write(*event);
  }
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Stand-in phones for wayfuse: a simulated building, surveyed and walked through the real SDK");
  app.require_subcommand(1);
  WorldOptions options;
  ServerAddress server;
  SurveyFleetSettings surveying;
  WalkFleetSettings walking;
  double record_minutes = 2;
  std::string record_file;

  auto* show = app.add_subcommand("world", "Print the building as POST /v1/buildings takes it");
  auto* survey_command = app.add_subcommand("survey", "Survey every floor and upload the reference points");
  auto* walk_command = app.add_subcommand("walk", "Walk phones through the building and show their errors");
  auto* record_command = app.add_subcommand("record", "Record one walk with its truth");
  for (auto* command : {show, survey_command, walk_command, record_command}) options.add_to(*command);

  show->add_option("--pipeline", options.pipeline, "Preset the building asks for");

  add_server_options(*survey_command, server, surveying.building);
  survey_command->add_option("--passes", surveying.passes, "Times every room is visited")->check(CLI::Range(1, 20));

  add_server_options(*walk_command, server, walking.building);
  walk_command->add_option("--phones", walking.phones, "How many")->check(CLI::Range(1, 5000));
  walk_command->add_option("--minutes", walking.minutes, "Of walking, on the phones' clocks")->check(CLI::Range(0.1, 1440.0));
  walk_command->add_option("--speed", walking.speed, "How fast those clocks run")->check(CLI::Range(0.1, 100.0));
  walk_command->add_option("--pipeline", walking.pipeline, "Preset to ask for instead of the building's own");
  walk_command->add_flag("--throttled", walking.throttled, "Four real scans in two minutes, as Android allows");
  walk_command->add_flag("!--no-compare", walking.compare, "Only the fused session, no Wi-Fi-only one beside it");

  record_command->add_option("--minutes", record_minutes, "Of walking")->check(CLI::Range(0.1, 1440.0));
  record_command->add_option("FILE", record_file, "Where to")->required();
  CLI11_PARSE(app, argc, argv);

  try {
    const World world = options.make();
    surveying.seed = walking.seed = options.seed;
    if (*show) std::cout << to_building_json(world) << '\n';
    if (*record_command) return record(world, options.seed, record_minutes, record_file);
    if (*survey_command) return survey(world, server, surveying, stdout);
    if (*walk_command) return walk(world, server, walking, stdout);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::cerr << "wayfuse-phone: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
}
