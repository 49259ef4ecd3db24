#include "sdk/src/simulator/surveying.hpp"

#include <algorithm>
#include <stdexcept>

#include "sdk/src/simulator/stand_in_phone.hpp"
#include "wayfuse/sdk/surveyor.hpp"

namespace wayfuse::simulator {
namespace {

// One tour through all rooms of a floor, in random order of passes so that corridors are walked both ways.
std::vector<std::size_t> tour(const World& world, FloorOrdinal floor, bool backwards) {
  std::vector<std::size_t> rooms;
  for (std::size_t i = 0; i < world.ways.size(); ++i) {
    if (world.ways[i].room && world.ways[i].place.floor == floor) rooms.push_back(i);
  }
  if (backwards) std::ranges::reverse(rooms);
  std::vector<std::size_t> nodes = {rooms.at(0)};
  for (std::size_t i = 1; i < rooms.size(); ++i) {
    const auto way = shortest_way(world, nodes.back(), rooms[i]);
    nodes.insert(nodes.end(), way.begin() + 1, way.end());
  }
  return nodes;
}

void must(const Result<void>& result) {
  if (!result) throw std::runtime_error("survey: " + to_string(result.fault()));
}

Place marked(const Truth& truth, double sigma_m, Random& random) {
  return {{truth.place.point.x_m + sigma_m * random.normal(), truth.place.point.y_m + sigma_m * random.normal()},
          truth.place.floor};
}

}  // namespace

std::vector<SurveyBatch> survey_floor(const World& world, const Propagation& propagation, FloorOrdinal floor, const Device& device,
                                      const SurveyingSettings& settings, Random random) {
  Surveyor surveyor(device.model, random.split());
  for (int pass = 0; pass < settings.passes; ++pass) {
    const Walker walker(world, {.speed_mps = 1.0, .step_length_m = 0.62}, tour(world, floor, pass % 2 == 1), random);
    StandInPhone phone(world, propagation, walker, {.device = device}, random.split());
    must(surveyor.begin_walk("floor " + std::to_string(floor.value) + " pass " + std::to_string(pass + 1)));
    PhoneTime next_mark = phone.next_time();
    while (const auto event = phone.next()) {
      const PhoneTime now = time_of(*event);
      if (now >= next_mark) {
        must(surveyor.mark(now, marked(phone.truth(now), settings.mark_sigma_m, random), settings.mark_sigma_m));
        next_mark = now + from_seconds(settings.mark_every_s);
      }
      if (const auto* scan = std::get_if<RssScan>(&*event)) must(surveyor.scan(*scan, settings.at));
    }
    must(surveyor.mark(phone.end(), marked(phone.truth(phone.end()), settings.mark_sigma_m, random), settings.mark_sigma_m));
    must(surveyor.end_walk());
  }
  return surveyor.take_batches();
}

}  // namespace wayfuse::simulator
