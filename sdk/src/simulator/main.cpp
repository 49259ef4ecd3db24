// wayfuse-phone: stand-in phones that survey a simulated building and walk through it. The SDK's reference user.

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

#include "sdk/src/simulator/fleet.hpp"
#include "sdk/src/simulator/recording_commands.hpp"

namespace {

using namespace wayfuse;
using namespace wayfuse::simulator;

struct WorldOptions {
  WorldSettings settings;
  std::uint64_t seed = 1;
  std::string kind = "office";
  std::string pipeline = "default";

  void add_to(CLI::App& app) {
    app.add_option("--seed", seed, "Of the world and everything in it");
    app.add_option("--kind", kind, "Of building")->check(CLI::IsMember(world_kind_names()));
    app.add_option("--floors", settings.floors, "Storeys");
    app.add_option("--length", settings.length_m, "Of a floor, metres");
    app.add_option("--width", settings.width_m, "Of a floor, metres");
    app.add_option("--transmitters", settings.transmitters_per_floor, "Access points a floor");
    app.add_option("--networks", settings.networks_per_transmitter, "Addresses an access point speaks with");
    app.add_option("--anomalies", settings.anomalies_per_floor, "Magnetic disturbances a floor");
  }
  World make() {
    settings.kind = *world_kind_of(kind);
    Random random(seed);
    World world = make_world(settings, random);
    world.pipeline = pipeline;
    return world;
  }
};

void add_options(CLI::App& app, RecordSettings& settings) {
  app.add_option("--minutes", settings.minutes, "Of walking")->check(CLI::Range(0.1, 1440.0));
  app.add_option("--carrying", settings.carrying, "texting, phoning, pocket, swinging, mixed or changing");
  app.add_option("--device", settings.device, "Model, like 'stand-in C'; otherwise any");
  app.add_flag("--throttled", settings.throttled, "Four real scans in two minutes, as Android allows");
  app.add_option("--walk", settings.walk, "Number of the walk: another one in the same world");
  app.add_option("FILE", settings.file, "Where to")->required();
}

void add_options(CLI::App& app, ImportCommand& import) {
  std::string formats;
  for (const ImportFormat& format : import_formats()) {
    formats += std::string("\n  ") + std::string(format.name) + ": " + std::string(format.about);
  }
  app.add_option("FORMAT", import.format, "One of" + formats)->required();
  app.add_option("FILE", import.from, "What to read")->required();
  app.add_option("--out", import.to, "Where to; otherwise standard output");
  app.add_option("--floor", import.floor, "Ordinal of its floor, 0 = ground, where its label does not say");
  app.add_option("--origin", import.origin, "LATITUDE LONGITUDE of the frame of its truth")->expected(2);
  app.add_option("--azimuth", import.azimuth_deg, "Of that frame's y axis, degrees clockwise from true north");
}

void add_server_options(CLI::App& app, ServerAddress& server, BuildingId& building) {
  app.add_option("--server", server.url, "Like ws://127.0.0.1:8420/v1/session")->required();
  app.add_option("--key", server.key, "API key; better given as WAYFUSE_KEY")->envname("WAYFUSE_KEY")->required();
  app.add_option("--authority", server.authority, "PEM file with the certificate authority to trust")->check(CLI::ExistingFile);
  app.add_option("--building", building.value, "Building id on the server")->required();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Stand-in phones for wayfuse: a simulated building, surveyed and walked through the real SDK");
  app.require_subcommand(1);
  WorldOptions options;
  ServerAddress server;
  SurveyFleetSettings surveying;
  WalkFleetSettings walking;
  RecordSettings recording;
  ImportCommand import;
  std::string replay_file;

  auto* show = app.add_subcommand("world", "Print the building as POST /v1/buildings takes it");
  auto* survey_command = app.add_subcommand("survey", "Survey every floor and upload the reference points");
  auto* walk_command = app.add_subcommand("walk", "Walk phones through the building and show their errors");
  auto* record_command = app.add_subcommand("record", "Record one walk with its truth");
  auto* import_command = app.add_subcommand("import", "Turn somebody else's recording into one of ours");
  auto* replay_command = app.add_subcommand("replay", "Live through a recording and show its errors against its truth marks");
  for (auto* command : {show, survey_command, walk_command, record_command}) options.add_to(*command);

  show->add_option("--pipeline", options.pipeline, "Preset the building asks for");

  add_server_options(*survey_command, server, surveying.building);
  survey_command->add_option("--passes", surveying.passes, "Times every room is visited")->check(CLI::Range(1, 20));

  add_server_options(*walk_command, server, walking.building);
  walk_command->add_option("--phones", walking.phones, "How many")->check(CLI::Range(1, 5000));
  walk_command->add_option("--minutes", walking.minutes, "Of walking, on the phones' clocks; drawn at the start, 0.4 MB a minute and phone")->check(CLI::Range(0.1, 1440.0));
  walk_command->add_option("--speed", walking.speed, "How fast those clocks run")->check(CLI::Range(0.1, 100.0));
  walk_command->add_option("--pipeline", walking.pipeline, "Preset to ask for instead of the building's own");
  walk_command->add_option("--carrying", walking.carrying, "texting, phoning, pocket, swinging, mixed or changing");
  walk_command->add_flag("--throttled", walking.throttled, "Four real scans in two minutes, as Android allows");
  walk_command->add_flag("!--no-compare", walking.compare, "Only the fused session, no Wi-Fi-only one beside it");

  add_options(*record_command, recording);
  add_options(*import_command, import);

  add_server_options(*replay_command, server, walking.building);
  replay_command->add_option("FILE", replay_file, "A recording, as `record` and `import` write it")->required();
  replay_command->add_option("--speed", walking.speed, "How fast its clock runs")->check(CLI::Range(0.1, 100.0));
  replay_command->add_option("--pipeline", walking.pipeline, "Preset to ask for instead of the building's own");
  replay_command->add_flag("!--no-compare", walking.compare, "Only the fused session, no Wi-Fi-only one beside it");
  CLI11_PARSE(app, argc, argv);

  try {
    if (*import_command) return import_file(import);
    if (*replay_command) return replay(replay_file, server, walking, stdout);
    const World world = options.make();
    surveying.seed = walking.seed = options.seed;
    if (*show) std::cout << to_building_json(world) << '\n';
    if (*record_command) return record(world, options.seed, recording);
    if (*survey_command) return survey(world, server, surveying, stdout);
    if (*walk_command) return walk(world, server, walking, stdout);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::cerr << "wayfuse-phone: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
}
