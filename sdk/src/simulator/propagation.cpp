#include "sdk/src/simulator/propagation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wayfuse::simulator {
namespace {

constexpr std::size_t kWaves = 24;
constexpr double kPhoneHeight_m = 1.2;

double cross(BuildingPoint o, BuildingPoint a, BuildingPoint b) {
  return (a.x_m - o.x_m) * (b.y_m - o.y_m) - (a.y_m - o.y_m) * (b.x_m - o.x_m);
}

bool crosses(const Wall& wall, BuildingPoint from, BuildingPoint to) {
  return cross(wall.from, wall.to, from) * cross(wall.from, wall.to, to) < 0 &&
         cross(from, to, wall.from) * cross(from, to, wall.to) < 0;
}

}  // namespace

Propagation::Propagation(const World& world, PropagationSettings settings) : world_(world), settings_(settings) {
  Random random(world.seed);
  const std::size_t patterns = world.transmitters.size() * world.floors.size();
  waves_.reserve(patterns * kWaves);
  for (std::size_t i = 0; i < patterns * kWaves; ++i) {
    // Wave numbers drawn from a Gaussian give a field with a Gaussian correlation of that reach.
    waves_.push_back({random.normal() / settings.shadowing_reach_m, random.normal() / settings.shadowing_reach_m,
                      2 * std::numbers::pi * random.uniform()});
  }
}

double Propagation::walls_db(const WorldFloor& floor, BuildingPoint from, BuildingPoint to) const {
  double loss_db = 0;
  for (const Wall& wall : floor.walls) {
    if (crosses(wall, from, to)) loss_db += wall.loss_db;
  }
  return std::min(loss_db, settings_.most_walls_db);
}

// Between storeys the way crosses the ceilings about half way.
double Propagation::storey_db(BuildingPoint from, BuildingPoint to) const {
  const BuildingPoint middle{0.5 * (from.x_m + to.x_m), 0.5 * (from.y_m + to.y_m)};
  const bool open = std::ranges::any_of(world_.openings, [&](const Polygon& opening) { return contains(opening, middle); });
  return open ? settings_.opening_loss_db : settings_.floor_loss_db;
}

double Propagation::shadow_db(std::size_t transmitter, const Place& at) const {
  std::size_t floor = 0;
  while (floor + 1 < world_.floors.size() && world_.floors[floor].plan.ordinal != at.floor) ++floor;
  const Wave* wave = &waves_[(transmitter * world_.floors.size() + floor) * kWaves];
  double sum = 0;
  for (std::size_t i = 0; i < kWaves; ++i) sum += std::cos(wave[i].kx * at.point.x_m + wave[i].ky * at.point.y_m + wave[i].phase);
  return settings_.shadowing_db * std::sqrt(2.0 / kWaves) * sum;
}

double Propagation::level_dbm(std::size_t index, const Place& at, Heading facing) const {
  const Transmitter& transmitter = world_.transmitters[index];
  const int storeys = std::abs(transmitter.floor.value - at.floor.value);
  const double flat_m = distance_m(transmitter.point, at.point);
  const double rise_m = storeys * world_.storey_m + transmitter.height_m - kPhoneHeight_m;
  const double far_m = std::max(1.0, std::hypot(flat_m, rise_m));
  const double open_dbm = transmitter.power_dbm - settings_.decay_db_per_decade * std::log10(far_m);
  const auto floor = std::ranges::find_if(world_.floors, [&](const WorldFloor& f) { return f.plan.ordinal == at.floor; });
  const double walls = floor != world_.floors.end() ? walls_db(*floor, transmitter.point, at.point) : 0.0;
  const Heading towards = Heading::from_vector(transmitter.point.x_m - at.point.x_m, transmitter.point.y_m - at.point.y_m);
  const double behind = 0.5 * (1.0 - std::cos(towards.minus(facing)));
  const double storeys_db = storeys > 0 ? storeys * storey_db(transmitter.point, at.point) : 0.0;
  return open_dbm - walls - storeys_db - settings_.body_db * behind * behind + shadow_db(index, at);
}

}  // namespace wayfuse::simulator
