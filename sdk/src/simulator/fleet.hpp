#pragma once

#include <cstdio>
#include <string>

#include "sdk/src/simulator/world.hpp"
#include "wayfuse/proto/place.hpp"

namespace wayfuse::simulator {

/// Where the stand-in phones report to.
struct ServerAddress {
  std::string url;          ///< ws://host:port/v1/session or wss://
  std::string key;
  std::string authority;    ///< PEM file to trust besides the system's; empty = none
};

struct SurveyFleetSettings {
  BuildingId building;
  int passes = 2;
  std::uint64_t seed = 1;
};

struct WalkFleetSettings {
  BuildingId building;
  int phones = 6;           ///< 1..5000
  double minutes = 3.0;     ///< of walking, on the phones' clocks
  double speed = 8.0;       ///< how fast those clocks run, 1..100
  bool compare = true;
  bool throttled = false;
  std::string carrying = "texting";   ///< as carrying_of() takes it
  std::string pipeline;
  std::uint64_t seed = 1;
};

/// Surveys every floor of the world and uploads it; returns the process' exit status: 0 = every point acknowledged.
int survey(const World& world, const ServerAddress& server, const SurveyFleetSettings& settings, std::FILE* out);

/// Walks phones through the world and shows their errors live; 0 = all went well and fusion won (where compared).
int walk(const World& world, const ServerAddress& server, const WalkFleetSettings& settings, std::FILE* out);

/// Lives through a recording and prints its errors against its truth marks; 0 = positions came and nothing was left over.
int replay(const std::string& file, const ServerAddress& server, const WalkFleetSettings& settings, std::FILE* out);

}  // namespace wayfuse::simulator
