#include <nlohmann/json.hpp>

#include "admin/json_field.hpp"
#include "admin/json_forms.hpp"
#include "admin/plan/planar.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

// As omlox has it: null = for ever.
std::optional<Duration> tolerance_in(const JsonField& json, const char* name, std::optional<Duration> standard) {
  constexpr std::int64_t kLongest_us = 366LL * 86'400 * 1'000'000;
  const auto found = json.maybe(name);
  if (found) {
    const std::int64_t value_us = found->whole(-1, kLongest_us);
    return value_us < 0 ? std::nullopt : std::optional(Duration(value_us));
  }
  return json.has(name) ? std::nullopt : standard;
}

Json duration_to_json(const std::optional<Duration>& duration) { return duration ? Json(duration->count()) : Json(nullptr); }

Json rings_to_json(const Polygon& polygon) {
  Json rings = Json::array();
  for (const Ring& ring : polygon.rings) {
    Json& points = rings.emplace_back(Json::array());
    for (const BuildingPoint& point : ring) points.push_back({point.x_m, point.y_m});
  }
  return rings;
}

Json form_of(const ZoneRecord& zone) {
  return {{"id", zone.id},
          {"name", zone.name},
          {"floor", zone.floor.value},
          {"region", rings_to_json(zone.region)},
          {"exit_tolerance_m", zone.exit_tolerance_m},
          {"tolerance_timeout_us", duration_to_json(zone.tolerance_timeout)},
          {"exit_delay_us", duration_to_json(zone.exit_delay)},
          {"timeout_us", duration_to_json(zone.timeout)}};
}

}  // namespace

Result<ZoneRecord> parse_zone(std::string_view json) {
  return JsonField::reading([&] {
    const JsonField whole = JsonField::object_in(json);
    ZoneRecord zone;
    zone.name = whole.member("name").text(256);
    if (zone.name.empty()) whole.member("name").refuse(FaultCode::kOutOfRange, "must not be empty");
    zone.floor = whole.member("floor").floor();
    const JsonField region = whole.member("region");
    zone.region = region.polygon();
    if (zone.region.rings.empty()) region.refuse(FaultCode::kMissingField, "a zone needs an outer ring");
    for (std::size_t i = 0; i < zone.region.rings.size(); ++i) {
      const auto flaw = planar::flaw_of(zone.region.rings[i]);
      if (!flaw) continue;
      char cause[160];
      std::snprintf(cause, sizeof cause, "%.80s at [%.2f, %.2f]", flaw->what.c_str(), flaw->at.x_m, flaw->at.y_m);
      region.list(SIZE_MAX)[i].refuse(FaultCode::kOutOfRange, cause);
    }
    zone.exit_tolerance_m = whole.number("exit_tolerance_m", 0, 0, 1000);
    zone.tolerance_timeout = tolerance_in(whole, "tolerance_timeout_us", zone.tolerance_timeout);
    zone.exit_delay = tolerance_in(whole, "exit_delay_us", zone.exit_delay);
    zone.timeout = tolerance_in(whole, "timeout_us", zone.timeout);
    return zone;
  });
}

std::string to_json(const ZoneRecord& zone) { return form_of(zone).dump(); }

std::string to_json(const std::vector<ZoneRecord>& zones, std::uint64_t next) {
  Json json;
  json["zones"] = Json::array();
  for (const ZoneRecord& zone : zones) json["zones"].push_back(form_of(zone));
  if (next != 0) json["next"] = next;
  return json.dump();
}

std::string to_json(const std::vector<ZoneOccupant>& occupants) {
  Json json;
  json["occupants"] = Json::array();
  for (const ZoneOccupant& occupant : occupants) {
    json["occupants"].push_back({{"tracked", occupant.tracked},
                                 {"since_us", occupant.since.time_since_epoch().count()},
                                 {"probability", occupant.probability}});
  }
  return json.dump();
}

}  // namespace wayfuse
