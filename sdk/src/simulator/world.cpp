#include "sdk/src/simulator/world.hpp"

#include <algorithm>
#include <limits>
#include <queue>
#include <stdexcept>

#include "sdk/src/simulator/floor_sketch.hpp"

namespace wayfuse::simulator {
namespace {

constexpr double kStairs_m = 20.0;     // what a storey of stairs is worth to a walker
constexpr double kEscalator_m = 6.0;   // its ride is worth so much of a walk
constexpr double kLiftWait_m = 8.0;    // entering or leaving one
constexpr double kLift_m = 2.0;        // per storey

double effort_m(const WayNode& a, const WayNode& b) {
  const double flat_m = distance_m(a.place.point, b.place.point);
  if (a.place.floor == b.place.floor) {
    const bool boarding = (a.passage == Passage::kLift) != (b.passage == Passage::kLift);
    return flat_m + (boarding ? kLiftWait_m : 0.0);
  }
  switch (a.passage) {
    case Passage::kLift: return kLift_m;
    case Passage::kEscalator: return kEscalator_m;
    default: return flat_m + kStairs_m;
  }
}

}  // namespace

const std::vector<std::string>& world_kind_names() {
  static const std::vector<std::string> names = {"office", "mall", "warehouse"};
  return names;
}

std::optional<WorldKind> world_kind_of(std::string_view name) {
  const auto& names = world_kind_names();
  const auto at = std::ranges::find(names, name);
  return at == names.end() ? std::nullopt : std::optional(static_cast<WorldKind>(at - names.begin()));
}

World make_world(const WorldSettings& settings, Random& random) {
  World world;
  switch (settings.kind) {
    case WorldKind::kOffice: world = make_office(settings, random); break;
    case WorldKind::kMall: world = make_mall(settings, random); break;
    case WorldKind::kWarehouse: world = make_warehouse(settings, random); break;
  }
  world.georeference = {{47.3769, 8.5417}, 0.2};
  world.magnetic_field = {0.05, 1.10, 48.0};
  return world;
}

std::vector<std::size_t> shortest_way(const World& world, std::size_t from, std::size_t to) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::vector<double> far(world.ways.size(), kFar);
  std::vector<std::size_t> before(world.ways.size(), from);
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  far[from] = 0;
  open.push({0, from});
  while (!open.empty()) {
    const auto [length_m, node] = open.top();
    open.pop();
    if (length_m > far[node]) continue;
    for (const std::size_t next : world.ways[node].neighbours) {
      const double through_m = length_m + effort_m(world.ways[node], world.ways[next]);
      if (through_m < far[next]) {
        far[next] = through_m;
        before[next] = node;
        open.push({through_m, next});
      }
    }
  }
  if (far[to] == kFar) return {};
  std::vector<std::size_t> way = {to};
  while (way.back() != from) way.push_back(before[way.back()]);
  std::ranges::reverse(way);
  return way;
}

}  // namespace wayfuse::simulator
