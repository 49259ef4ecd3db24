#include <algorithm>
#include <charconv>
#include <map>
#include <numbers>

#include "admin/api.hpp"
#include "admin/conditional.hpp"
#include "admin/plan/image_header.hpp"
#include "admin/plan_forms.hpp"
#include "admin/query_values.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kPlanBytes = 32u << 20;
constexpr std::size_t kImageBytes = 16u << 20;

struct PlanRooms {
  DatabaseDirectory& databases;
  ServerControl& server;
  ZoneControl& zones;
  RunLater run;
};

// ---------------------------------------------------------------- plans

struct PlanRequest {
  PlanOptions options;
  bool dry_run = false;
  bool make_zones = false;
};

Result<PlanRequest> plan_request(const Request& request) {
  PlanRequest wanted;
  const auto floor = floor_in(request);
  if (!floor) return floor.fault();
  wanted.options.floor = *floor;
  if (const auto label = request.query.find("label"); label != request.query.end()) {
    if (label->second.size() > 64) return Fault{FaultCode::kTooLarge, "label", "is longer than 64 bytes"};
    wanted.options.label = label->second;
  }
  if (const auto kind = request.query.find("coordinates"); kind != request.query.end()) {
    using Coordinates = PlanOptions::Coordinates;
    static const std::map<std::string, Coordinates> known = {
        {"wgs84", Coordinates::kWgs84}, {"mercator", Coordinates::kMercator}, {"local", Coordinates::kLocal}};
    const auto found = known.find(kind->second);
    if (found == known.end()) return Fault{FaultCode::kUnknownName, "coordinates", "'" + kind->second + "' is none of wgs84, mercator, local"};
    wanted.options.coordinates = found->second;
  }
  if (const auto rooms = request.query.find("rooms"); rooms != request.query.end()) {
    if (rooms->second != "closed" && rooms->second != "walkable") {
      return Fault{FaultCode::kUnknownName, "rooms", "'" + rooms->second + "' is none of closed, walkable"};
    }
    wanted.options.rooms_walkable = rooms->second == "walkable";
  }
  for (const auto& [name, into] : {std::pair{"dry_run", &wanted.dry_run}, std::pair{"zones", &wanted.make_zones}}) {
    const auto flag = flag_in(request, name);
    if (!flag) return flag.fault();
    *into = *flag;
  }
  return wanted;
}

// Rooms with a name, as zones to be.
std::vector<ZoneRecord> zones_of(const Plan& plan) {
  std::vector<ZoneRecord> zones;
  for (const PlanFloor& floor : plan.floors) {
    for (const PlanRoom& room : floor.rooms) {
      if (room.name.empty()) continue;
      ZoneRecord zone;
      zone.name = room.name;
      zone.floor = floor.ordinal;
      zone.region = room.polygon;
      zones.push_back(std::move(zone));
    }
  }
  return zones;
}

// Where the survey stood is the best witness of a plan in the wrong place.
Result<void> hold_against_survey(BuildingDatabase& database, const std::vector<Floor>& floors, Plan& plan) {
  std::map<FloorOrdinal, std::pair<std::size_t, std::size_t>> counted;  // points, of them inside
  for (PointQuery query;;) {
    const auto page = database.points(query);
    if (!page) return page.fault();
    if (page->empty()) break;
    query.after_id = page->back().id;
    for (const StoredPoint& stored : *page) {
      const Place& place = stored.point.place;
      const auto floor = std::ranges::find(floors, place.floor, &Floor::ordinal);
      if (floor == floors.end()) continue;
      auto& [points, inside] = counted[place.floor];
      ++points;
      inside += contains(floor->outline, place.point);
    }
  }
  for (const auto& [floor, count] : counted) {
    const auto [points, inside] = count;
    const auto severity = 10 * inside < 9 * points ? PlanCheck::Severity::kWarning : PlanCheck::Severity::kNote;
    plan.check(severity, "survey", "floor " + std::to_string(floor.value),
               std::to_string(inside) + " of " + std::to_string(points) + " reference points lie inside the outline");
  }
  return {};
}

void merge(std::vector<Floor>& into, const std::vector<Floor>& floors) {
  for (const Floor& floor : floors) {
    const auto place = std::ranges::lower_bound(into, floor.ordinal, {}, &Floor::ordinal);
    if (place != into.end() && place->ordinal == floor.ordinal) {
      *place = floor;
    } else {
      into.insert(place, floor);
    }
  }
}

struct ReadPlan {
  Plan plan;
  std::vector<Floor> floors;
  std::vector<ZoneRecord> zones;
};

void store_plan(PlanRooms rooms, BuildingId id, const PlanRequest& wanted, ReadPlan read, Respond respond) {
  rooms.databases.with_building(id, [rooms, id, wanted, read = std::move(read), respond](Result<BuildingDatabase*> database) mutable {
    if (!database) return respond(problem(database.fault()));
    auto record = (*database)->building();
    if (!record) return respond(problem(record.fault()));
    if (record->georeference != wanted.options.georeference) {
      return respond(problem({FaultCode::kConflict, "georeference", "it was changed while the plan was read: send it again"}));
    }
    if (const auto held = hold_against_survey(**database, read.floors, read.plan); !held) return respond(problem(held.fault()));
    if (!read.plan.sound()) return respond(json_response(422, to_json(read.plan, read.floors, read.zones, false)));
    if (wanted.dry_run) return respond(json_response(200, to_json(read.plan, read.floors, read.zones, false)));
    merge(record->floors, read.floors);
    if (!record->georeference) record->georeference = read.plan.georeference;
    if (const auto stored = (*database)->update(*record); !stored) return respond(problem(stored.fault()));
    if (wanted.make_zones) {
      for (ZoneRecord& zone : read.zones) {
        auto made = (*database)->put_zone(zone);
        if (!made) return respond(problem(made.fault()));
        zone = *std::move(made);
      }
      rooms.zones.zones_changed(id);
    }
    rooms.server.building_changed(id);
    respond(json_response(200, to_json(read.plan, read.floors, read.zones, true)));
  });
}

void put_plan(PlanRooms rooms, BuildingId id, const Request& request, Respond respond) {
  auto wanted = plan_request(request);
  if (!wanted) return respond(problem(wanted.fault()));
  rooms.databases.with_building(id, [rooms, id, wanted = *wanted, file = request.body, respond](Result<BuildingDatabase*> database) mutable {
    if (!database) return respond(problem(database.fault()));
    const auto record = (*database)->building();
    if (!record) return respond(problem(record.fault()));
    wanted.options.georeference = record->georeference;
    // Off the store's thread: a mall's geometry takes its time.
    rooms.run([rooms, id, wanted, file = std::move(file), respond] {
      auto plan = read_plan(file, wanted.options);
      if (!plan) return respond(problem(plan.fault()));
      ReadPlan read{*std::move(plan), {}, {}};
      read.floors = floors_of(read.plan, wanted.options);
      read.zones = zones_of(read.plan);
      store_plan(rooms, id, wanted, std::move(read), respond);
    });
  });
}

// ---------------------------------------------------------------- georeference

void put_georeference(PlanRooms rooms, BuildingId id, const Request& request, Respond respond) {
  const auto points = parse_control_points(request.body);
  if (!points) return respond(problem(points.fault()));
  const auto dry_run = flag_in(request, "dry_run");
  if (!dry_run) return respond(problem(dry_run.fault()));
  const auto fit = fit_georeference(*points);
  if (!fit) return respond(problem(fit.fault()));
  const bool refused = std::ranges::any_of(fit->checks, [](const PlanCheck& check) { return check.severity == PlanCheck::Severity::kError; });
  if (refused || *dry_run) return respond(json_response(refused ? 422 : 200, to_json(*fit, false)));
  rooms.databases.with_building(id, [rooms, id, fit = *fit, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    auto record = (*database)->building();
    if (!record) return respond(problem(record.fault()));
    record->georeference = fit.georeference;
    if (const auto stored = (*database)->update(*record); !stored) return respond(problem(stored.fault()));
    rooms.server.building_changed(id);
    respond(json_response(200, to_json(fit, true)));
  });
}

// ---------------------------------------------------------------- floor images

Result<FloorOrdinal> floor_of_path(const PathValues& path) {
  const std::string& text = path.at("floor");
  std::int32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return Fault{FaultCode::kNotFound, "floor", "there is no such floor"};
  return FloorOrdinal{value};
}

// Where a picture lies that says nothing: over the box around the floor's outline.
void lay_over_outline(FloorImage& image, const Floor& floor) {
  BuildingPoint low{1e300, 1e300};
  BuildingPoint high{-1e300, -1e300};
  for (const Ring& ring : floor.outline.rings) {
    for (const BuildingPoint& p : ring) {
      low = {std::min(low.x_m, p.x_m), std::min(low.y_m, p.y_m)};
      high = {std::max(high.x_m, p.x_m), std::max(high.y_m, p.y_m)};
    }
  }
  image.origin = low;
  image.width_m = high.x_m - low.x_m;
  image.height_m = high.y_m - low.y_m;
}

struct Placement {
  bool given = false;
  double origin_x_m = 0, origin_y_m = 0, width_m = 0, height_m = 0, azimuth_deg = 0;
};

Result<Placement> placement_in(const Request& request) {
  Placement placement;
  placement.given = request.query.contains("width_m");
  struct Row {
    const char* name;
    double* into;
    double least, most;
  };
  for (const Row& row : {Row{"origin_x_m", &placement.origin_x_m, -1e5, 1e5}, Row{"origin_y_m", &placement.origin_y_m, -1e5, 1e5},
                         Row{"width_m", &placement.width_m, 0.1, 1e5}, Row{"height_m", &placement.height_m, 0.1, 1e5},
                         Row{"azimuth_deg", &placement.azimuth_deg, -360, 360}}) {
    if (!request.query.contains(row.name)) continue;
    if (!placement.given) return Fault{FaultCode::kMissingField, "width_m", "is needed where a placement is given"};
    const auto value = number_in<double>(request, row.name, 0, row.least, row.most);
    if (!value) return value.fault();
    *row.into = *value;
  }
  return placement;
}

void put_image(PlanRooms rooms, BuildingId id, FloorOrdinal ordinal, const Request& request, Respond respond) {
  const auto header = image_header(request.body);
  if (!header) return respond(problem(header.fault()));
  const auto placement = placement_in(request);
  if (!placement) return respond(problem(placement.fault()));
  FloorImage image;
  image.floor = ordinal;
  image.media_type = header->media_type;
  image.width_px = header->width_px;
  image.height_px = header->height_px;
  image.content = request.body;
  if (placement->given) {
    image.origin = {placement->origin_x_m, placement->origin_y_m};
    image.width_m = placement->width_m;
    image.height_m = placement->height_m > 0 ? placement->height_m : placement->width_m * header->height_px / header->width_px;
    image.azimuth_rad = placement->azimuth_deg * std::numbers::pi / 180.0;
  }
  rooms.databases.with_building(id, [image = std::move(image), given = placement->given, respond](Result<BuildingDatabase*> database) mutable {
    if (!database) return respond(problem(database.fault()));
    const auto record = (*database)->building();
    if (!record) return respond(problem(record.fault()));
    const auto floor = std::ranges::find(record->floors, image.floor, &Floor::ordinal);
    if (floor == record->floors.end()) return respond(problem({FaultCode::kNotFound, "floor", "the building has no floor " + std::to_string(image.floor.value)}));
    if (!given && floor->outline.rings.empty()) {
      return respond(problem({FaultCode::kMissingField, "width_m", "the floor has no outline to lay the image over: say where it lies"}));
    }
    if (!given) lay_over_outline(image, *floor);
    const auto stored = (*database)->put_floor_image(image);
    respond(stored ? json_response(200, to_json(image)) : problem(stored.fault()));
  });
}

void with_image(PlanRooms rooms, BuildingId id, FloorOrdinal ordinal, Respond respond, std::function<Response(FloorImage)> show) {
  rooms.databases.with_building(id, [ordinal, respond, show](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    auto image = (*database)->floor_image(ordinal);
    respond(image ? show(*std::move(image)) : problem(image.fault()));
  });
}

void get_image(PlanRooms rooms, BuildingId id, FloorOrdinal ordinal, const Request& request, Respond respond) {
  with_image(rooms, id, ordinal, std::move(respond), [request](FloorImage image) {
    Response response = json_response(200, std::move(image.content));
    response.content_type = image.media_type;
    response.headers["x-content-type-options"] = "nosniff";
    return with_etag(request, std::move(response));
  });
}

void get_placement(PlanRooms rooms, BuildingId id, FloorOrdinal ordinal, const Request& request, Respond respond) {
  with_image(rooms, id, ordinal, std::move(respond),
             [request](const FloorImage& image) { return with_etag(request, json_response(200, to_json(image))); });
}

void delete_image(PlanRooms rooms, BuildingId id, FloorOrdinal ordinal, const Request&, Respond respond) {
  rooms.databases.with_building(id, [ordinal, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto removed = (*database)->remove_floor_image(ordinal);
    respond(removed ? json_response(204, "") : problem(removed.fault()));
  });
}

using OnFloor = void (*)(PlanRooms, BuildingId, FloorOrdinal, const Request&, Respond);

Handler on_floor(PlanRooms rooms, OnFloor handler) {
  return [rooms, handler](const Request& request, const PathValues& path, Respond respond) {
    const auto building = building_in(path);
    if (!building) return respond(problem(building.fault()));
    const auto floor = floor_of_path(path);
    if (!floor) return respond(problem(floor.fault()));
    handler(rooms, *building, *floor, request, std::move(respond));
  };
}

}  // namespace

void add_plan_routes(Router& router, DatabaseDirectory& databases, ServerControl& server, ZoneControl& zones, RunLater run) {
  const PlanRooms rooms{databases, server, zones, std::move(run)};
  Route plan{"PUT", "/v1/buildings/{building}/plan", Scope::kAdmin, "Read floors from GeoJSON or an IMDF archive, with checks",
             on_building([rooms](BuildingId id, const Request& request, Respond respond) { put_plan(rooms, id, request, std::move(respond)); })};
  plan.body_bytes = kPlanBytes;
  router.add(std::move(plan));
  router.add({"PUT", "/v1/buildings/{building}/georeference", Scope::kAdmin, "Lay the building on the earth by control points",
              on_building([rooms](BuildingId id, const Request& request, Respond respond) {
                put_georeference(rooms, id, request, std::move(respond));
              })});
  const std::string image = "/v1/buildings/{building}/floors/{floor}/image";
  Route put{"PUT", image, Scope::kAdmin, "A floor's picture, PNG or JPEG, and where it lies", on_floor(rooms, put_image)};
  put.body_bytes = kImageBytes;
  router.add(std::move(put));
  router.add({"GET", image, Scope::kObserve, "A floor's picture", on_floor(rooms, get_image), false, true});
  router.add({"GET", image + "/placement", Scope::kObserve, "Where a floor's picture lies", on_floor(rooms, get_placement), false, true});
  router.add({"DELETE", image, Scope::kAdmin, "Remove a floor's picture", on_floor(rooms, delete_image)});
}

}  // namespace wayfuse
