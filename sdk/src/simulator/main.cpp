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

struct RecordOptions {
  double minutes = 2;
  std::string carrying = "texting";
  std::string device;
  bool throttled = false;
  std::uint64_t walk = 0;
  std::string file;

  void add_to(CLI::App& app) {
    app.add_option("--minutes", minutes, "Of walking")->check(CLI::Range(0.1, 1440.0));
    app.add_option("--carrying", carrying, "texting, phoning, pocket, swinging, mixed or changing");
    app.add_option("--device", device, "Model, like 'stand-in C'; otherwise any");
    app.add_flag("--throttled", throttled, "Four real scans in two minutes, as Android allows");
    app.add_option("--walk", walk, "Number of the walk: another one in the same world");
    app.add_option("FILE", file, "Where to")->required();
  }
};

void add_server_options(CLI::App& app, ServerAddress& server, BuildingId& building) {
  app.add_option("--server", server.url, "Like ws://127.0.0.1:8420/v1/session")->required();
  app.add_option("--key", server.key, "API key; better given as WAYFUSE_KEY")->envname("WAYFUSE_KEY")->required();
  app.add_option("--authority", server.authority, "PEM file with the certificate authority to trust")->check(CLI::ExistingFile);
  app.add_option("--building", building.value, "Building id on the server")->required();
}

int record(const World& world, std::uint64_t seed, const RecordOptions& options) {
  Random random(seed + 0x9e37'79b9'7f4a'7c15u * options.walk);
  const Propagation propagation(world, {});
  const Walker walker(world, {}, from_seconds(60 * options.minutes), {}, random);
  StandInSettings settings;
  settings.device = options.device.empty() ? draw_device(random) : draw_device(options.device, random);
  settings.carrying = carrying_of(options.carrying, random);
  settings.scanner.throttled = options.throttled;
  StandInPhone phone(world, propagation, walker, settings, random.split());
  const std::string& file = options.file;
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
  RecordOptions recording;

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
  walk_command->add_option("--carrying", walking.carrying, "texting, phoning, pocket, swinging, mixed or changing");
  walk_command->add_flag("--throttled", walking.throttled, "Four real scans in two minutes, as Android allows");
  walk_command->add_flag("!--no-compare", walking.compare, "Only the fused session, no Wi-Fi-only one beside it");

  recording.add_to(*record_command);
  CLI11_PARSE(app, argc, argv);

  try {
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
