#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sdk/src/recording/import/import.hpp"
#include "sdk/src/simulator/world.hpp"

namespace wayfuse::simulator {

struct RecordSettings {
  double minutes = 2;
  std::string carrying = "texting";   ///< as carrying_of() takes it
  std::string device;                 ///< a model; empty = any
  bool throttled = false;
  std::uint64_t walk = 0;             ///< another number, another walk in the same world
  std::string file;
};

/// Writes one walk with a truth mark a second; returns the process' exit status.
int record(const World& world, std::uint64_t seed, const RecordSettings& settings);

struct ImportCommand {
  std::string format, from, to;
  std::optional<int> floor;
  std::vector<double> origin;         ///< latitude and longitude, or empty
  double azimuth_deg = 0.0;
};

/// Writes the recording, says on standard error what was left out; returns the process' exit status.
int import_file(const ImportCommand& command);

}  // namespace wayfuse::simulator
