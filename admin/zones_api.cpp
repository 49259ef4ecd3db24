#include <algorithm>

#include "admin/api.hpp"
#include "admin/conditional.hpp"
#include "admin/event_stream.hpp"
#include "admin/json_forms.hpp"
#include "admin/query_values.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kMostZones = 10'000;

struct ZoneRooms {
  DatabaseDirectory& databases;
  ZoneControl& zones;
};

Result<ZoneRecord> zone_in(BuildingDatabase& database, std::uint64_t id) {
  auto zones = database.zones();
  if (!zones) return zones.fault();
  const auto found = std::ranges::find(*zones, id, &ZoneRecord::id);
  if (found == zones->end()) return Fault{FaultCode::kNotFound, "zone", "there is no zone " + std::to_string(id)};
  return std::move(*found);
}

Response zone_response(int status, const ZoneRecord& zone) {
  Response response = json_response(status, to_json(zone));
  response.headers["etag"] = etag_of(response.body);
  return response;
}

void list_zones(ZoneRooms rooms, BuildingId id, const Request& request, Respond respond) {
  const auto page = page_in(request);
  if (!page) return respond(problem(page.fault()));
  const auto floor = floor_in(request);
  if (!floor) return respond(problem(floor.fault()));
  rooms.databases.with_building(id, [request, page = *page, floor = *floor, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    auto zones = (*database)->zones();
    if (!zones) return respond(problem(zones.fault()));
    std::erase_if(*zones, [&](const ZoneRecord& zone) { return zone.id <= page.after || (floor && zone.floor != *floor); });
    const bool more = zones->size() > page.most;
    if (more) zones->resize(page.most);
    respond(with_etag(request, json_response(200, to_json(*zones, more ? zones->back().id : 0))));
  });
}

void make_zone(ZoneRooms rooms, BuildingId id, const Request& request, Respond respond) {
  auto zone = parse_zone(request.body);
  if (!zone) return respond(problem(zone.fault()));
  rooms.databases.with_building(id, [rooms, id, zone = *std::move(zone), respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto there = (*database)->zones();
    if (!there) return respond(problem(there.fault()));
    if (there->size() >= kMostZones) return respond(problem({FaultCode::kTooLarge, "zones", "a building has at most 10000 zones"}));
    const auto made = (*database)->put_zone(zone);
    if (!made) return respond(problem(made.fault()));
    rooms.zones.zones_changed(id);
    Response response = zone_response(201, *made);
    response.headers["location"] = "/v1/buildings/" + std::to_string(id.value) + "/zones/" + std::to_string(made->id);
    respond(std::move(response));
  });
}

void show_zone(ZoneRooms rooms, BuildingId id, std::uint64_t zone_id, const Request& request, Respond respond) {
  rooms.databases.with_building(id, [zone_id, request, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto zone = zone_in(**database, zone_id);
    respond(zone ? with_etag(request, json_response(200, to_json(*zone))) : problem(zone.fault()));
  });
}

void replace_zone(ZoneRooms rooms, BuildingId id, std::uint64_t zone_id, const Request& request, Respond respond) {
  auto wanted = parse_zone(request.body);
  if (!wanted) return respond(problem(wanted.fault()));
  wanted->id = zone_id;
  rooms.databases.with_building(id, [rooms, id, wanted = *std::move(wanted), request, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto zone = zone_in(**database, wanted.id);
    if (!zone) return respond(problem(zone.fault()));
    if (auto refused = changed_since(request, to_json(*zone))) return respond(*std::move(refused));
    const auto stored = (*database)->put_zone(wanted);
    if (!stored) return respond(problem(stored.fault()));
    rooms.zones.zones_changed(id);
    respond(zone_response(200, *stored));
  });
}

void remove_zone(ZoneRooms rooms, BuildingId id, std::uint64_t zone_id, const Request& request, Respond respond) {
  rooms.databases.with_building(id, [rooms, id, zone_id, request, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto zone = zone_in(**database, zone_id);
    if (!zone) return respond(problem(zone.fault()));
    if (auto refused = changed_since(request, to_json(*zone))) return respond(*std::move(refused));
    const auto removed = (*database)->remove_zone(zone_id);
    if (!removed) return respond(problem(removed.fault()));
    rooms.zones.zones_changed(id);
    respond(json_response(204, ""));
  });
}

void show_occupants(ZoneRooms rooms, BuildingId id, std::uint64_t zone_id, const Request&, Respond respond) {
  rooms.databases.with_building(id, [rooms, id, zone_id, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto zone = zone_in(**database, zone_id);
    respond(zone ? json_response(200, to_json(rooms.zones.occupants(id, zone_id))) : problem(zone.fault()));
  });
}

using OnZone = void (*)(ZoneRooms, BuildingId, std::uint64_t, const Request&, Respond);

Handler on_zone(ZoneRooms rooms, OnZone handler) {
  return [rooms, handler](const Request& request, const PathValues& path, Respond respond) {
    const auto building = building_in(path);
    if (!building) return respond(problem(building.fault()));
    const auto zone = id_in(path, "zone");
    if (!zone) return respond(problem(zone.fault()));
    handler(rooms, *building, *zone, request, std::move(respond));
  };
}

void follow_events(ZoneRooms rooms, const Access& access, const Clock& clock, BuildingId id, const Request& request, Respond respond) {
  auto begin = event_stream_begin(request, rooms.zones);
  if (!begin) return respond(problem(begin.fault()));
  Response response;
  response.content_type = "text/event-stream";
  response.headers["cache-control"] = "no-store";
  response.headers["x-accel-buffering"] = "no";  // proxies that gather would hold events back
  response.stream = event_stream(rooms.zones, id, *begin, clock, [&access, authorization = request.headers.at("authorization")] {
    const auto space = authorization.find(' ');
    return access.principal_of(space == std::string::npos ? "" : std::string_view(authorization).substr(space + 1)).has_value();
  });
  respond(std::move(response));
}

}  // namespace

void add_zone_routes(Router& router, DatabaseDirectory& databases, ZoneControl& zones, const Access& access, const Clock& clock) {
  const ZoneRooms rooms{databases, zones};
  router.add({"GET", "/v1/buildings/{building}/zones", Scope::kObserve, "Zones, a page at a time",
              on_building([rooms](BuildingId id, const Request& request, Respond respond) {
                list_zones(rooms, id, request, std::move(respond));
              }),
              false, true});
  router.add({"POST", "/v1/buildings/{building}/zones", Scope::kAdmin, "Make a zone",
              on_building([rooms](BuildingId id, const Request& request, Respond respond) {
                make_zone(rooms, id, request, std::move(respond));
              })});
  router.add({"GET", "/v1/buildings/{building}/zones/{zone}", Scope::kObserve, "One zone", on_zone(rooms, show_zone), false, true});
  router.add({"PUT", "/v1/buildings/{building}/zones/{zone}", Scope::kAdmin, "Replace a zone", on_zone(rooms, replace_zone)});
  router.add({"DELETE", "/v1/buildings/{building}/zones/{zone}", Scope::kAdmin, "Remove a zone", on_zone(rooms, remove_zone)});
  router.add({"GET", "/v1/buildings/{building}/zones/{zone}/occupants", Scope::kObserve, "Phones in a zone now",
              on_zone(rooms, show_occupants), true, true});
  router.add({"GET", "/v1/buildings/{building}/events", Scope::kObserve, "Zone events as they happen: server-sent events",
              on_existing(databases, [rooms, &access, &clock](BuildingId id, const Request& request, Respond respond) {
                follow_events(rooms, access, clock, id, request, std::move(respond));
              }),
              true, true});
}

}  // namespace wayfuse
