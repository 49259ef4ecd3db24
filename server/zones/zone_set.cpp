#include "server/zones/zone_set.hpp"

#include <algorithm>
#include <cmath>

#include "admin/plan/planar.hpp"

namespace wayfuse {
namespace {

constexpr double kNegligible = 5.0;  // standard deviations

std::vector<SignedRing> signed_rings(const Polygon& polygon) {
  std::vector<SignedRing> rings;
  for (auto& [ring, hole] : planar::outlines_of(polygon)) rings.push_back({std::move(ring), hole});
  return rings;
}

PreparedZone prepared(ZoneRecord record) {
  PreparedZone zone;
  zone.region = signed_rings(record.region);
  if (record.exit_tolerance_m > 0.0) zone.tolerated = signed_rings(planar::grown(record.region, record.exit_tolerance_m));
  zone.low = {1e300, 1e300};
  zone.high = {-1e300, -1e300};
  for (const SignedRing& part : zone.tolerated.empty() ? zone.region : zone.tolerated) {
    for (const BuildingPoint& point : part.ring) {
      zone.low = {std::min(zone.low.x_m, point.x_m), std::min(zone.low.y_m, point.y_m)};
      zone.high = {std::max(zone.high.x_m, point.x_m), std::max(zone.high.y_m, point.y_m)};
    }
  }
  zone.record = std::move(record);
  return zone;
}

double probability_of(const FusedPosition& position, FloorOrdinal floor) {
  if (position.floors.empty()) return position.place.floor == floor ? 1.0 : 0.0;
  const auto found = std::ranges::find(position.floors, floor, &FloorProbability::floor);
  return found != position.floors.end() ? found->probability : 0.0;
}

bool out_of_reach(const PreparedZone& zone, const FusedPosition& position) {
  const BuildingPoint point = position.place.point;
  const double reach_x = kNegligible * std::sqrt(std::max(position.covariance.xx_m2, 0.01));
  const double reach_y = kNegligible * std::sqrt(std::max(position.covariance.yy_m2, 0.01));
  return point.x_m < zone.low.x_m - reach_x || point.x_m > zone.high.x_m + reach_x || point.y_m < zone.low.y_m - reach_y ||
         point.y_m > zone.high.y_m + reach_y;
}

}  // namespace

ZoneSet::ZoneSet(std::vector<ZoneRecord> zones) {
  for (ZoneRecord& zone : zones) {
    const FloorOrdinal floor = zone.floor;
    floors_[floor].push_back(prepared(std::move(zone)));
  }
}

const std::vector<PreparedZone>& ZoneSet::on_floor(FloorOrdinal floor) const {
  static const std::vector<PreparedZone> none;
  const auto found = floors_.find(floor);
  return found != floors_.end() ? found->second : none;
}

const PreparedZone* ZoneSet::find(std::uint64_t id) const {
  for (const auto& [floor, zones] : floors_) {
    for (const PreparedZone& zone : zones) {
      if (zone.record.id == id) return &zone;
    }
  }
  return nullptr;
}

ZoneMass mass_in(const PreparedZone& zone, const FusedPosition& position) {
  const double floor = probability_of(position, zone.record.floor);
  if (floor <= 0.0 || out_of_reach(zone, position)) return {};
  ZoneMass mass;
  mass.region = floor * gaussian_mass(position.place.point, position.covariance, zone.region);
  mass.tolerated = zone.tolerated.empty()
                       ? mass.region
                       : std::max(mass.region, floor * gaussian_mass(position.place.point, position.covariance, zone.tolerated));
  return mass;
}

}  // namespace wayfuse
