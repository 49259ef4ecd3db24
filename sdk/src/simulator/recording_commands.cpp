#include "sdk/src/simulator/recording_commands.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <numbers>
#include <stdexcept>

#include "sdk/src/simulator/stand_in_phone.hpp"

namespace wayfuse::simulator {
namespace {

constexpr std::size_t kComplaintsShown = 20;

std::ofstream opened(const std::string& file) {
  std::ofstream out(file);
  if (!out) throw std::runtime_error(file + " cannot be written");
  return out;
}

void write(std::ostream& out, const ImportedRecording& recording) {
  RecordingWriter writer(out, recording.header);
  for (const RecordedEvent& event : recording.events) writer.write(event);
  out.flush();
  if (!out) throw std::runtime_error("the recording could not be written to its end");
}

}  // namespace

int record(const World& world, std::uint64_t seed, const RecordSettings& wanted) {
  Random random(seed + 0x9e37'79b9'7f4a'7c15u * wanted.walk);
  const Propagation propagation(world, {});
  const Walker walker(world, {}, from_seconds(60 * wanted.minutes), {}, random);
  StandInSettings settings;
  settings.device = wanted.device.empty() ? draw_device(random) : draw_device(wanted.device, random);
  settings.carrying = carrying_of(wanted.carrying, random);
  settings.scanner.throttled = wanted.throttled;
  StandInPhone phone(world, propagation, walker, settings, random.split());
  std::ofstream out = opened(wanted.file);
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

int import_file(const ImportCommand& command) {
  ImportSettings settings;
  if (command.floor) settings.floor = FloorOrdinal{*command.floor};
  if (!command.origin.empty()) {
    settings.georeference =
        Georeference{{command.origin.at(0), command.origin.at(1)}, command.azimuth_deg * std::numbers::pi / 180.0};
  }
  const auto recording = import_recording(command.format, command.from, settings);
  if (!recording) throw std::invalid_argument(to_string(recording.fault()));
  const auto& complaints = recording->complaints;
  for (std::size_t i = 0; i < complaints.size() && i < kComplaintsShown; ++i) std::cerr << complaints[i] << '\n';
  if (complaints.size() > kComplaintsShown) std::cerr << "... and " << complaints.size() - kComplaintsShown << " more\n";
  if (command.to.empty()) {
    write(std::cout, *recording);
  } else {
    std::ofstream out = opened(command.to);
    write(out, *recording);
  }
  return EXIT_SUCCESS;
}

}  // namespace wayfuse::simulator
