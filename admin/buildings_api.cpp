#include <algorithm>
#include <atomic>
#include <charconv>
#include <memory>
#include <mutex>

#include "admin/api.hpp"
#include "admin/conditional.hpp"
#include "admin/json_forms.hpp"
#include "admin/query_values.hpp"

namespace wayfuse {
namespace {

// Asks every building's database for its record; answers when the last one has.
struct Listing {
  std::mutex mutex;
  std::vector<BuildingRecord> found;
  std::size_t open = 0;
  Page page;
  Respond respond;

  void arrived(std::optional<BuildingRecord> record) {
    {
      const std::lock_guard lock(mutex);
      if (record) found.push_back(std::move(*record));
      if (--open > 0) return;
    }
    std::ranges::sort(found, {}, &BuildingRecord::id);
    const std::uint64_t next = cut_to(page, found, [](const BuildingRecord& building) { return building.id.value; });
    respond(json_response(200, to_json(found, next)));
  }
};

Result<void> known_pipeline(const BuildingRecord& building, const ServerControl& server) {
  const std::vector<std::string> presets = server.presets();
  if (std::ranges::count(presets, building.pipeline) > 0) return {};
  std::string known;
  for (const std::string& preset : presets) known += (known.empty() ? "" : ", ") + preset;
  return Fault{FaultCode::kUnknownName, "pipeline", "'" + building.pipeline + "' is none of " + known};
}

// The ETag covers what an operator describes, not how the survey goes.
std::string described(BuildingRecord building) {
  building.survey_version = 0;
  return to_json(building, 0, 0);
}

void answer_with_building(DatabaseDirectory& databases, const ServerControl& server, BuildingId id, int status, Respond respond) {
  databases.with_building(id, [&server, id, status, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto record = (*database)->building();
    if (!record) return respond(problem(record.fault()));
    const auto points = (*database)->count_points();
    if (!points) return respond(problem(points.fault()));
    Response response = json_response(status, to_json(*record, *points, server.radio_map_version(id)));
    response.headers["etag"] = etag_of(described(*record));
    if (status == 201) response.headers["location"] = "/v1/buildings/" + std::to_string(id.value);
    respond(std::move(response));
  });
}

void list_buildings(DatabaseDirectory& databases, const Request& request, Respond respond) {
  const auto page = page_asked_in(request);
  if (!page) return respond(problem(page.fault()));
  const std::vector<BuildingId> ids = databases.buildings();
  if (ids.empty()) return respond(json_response(200, to_json(std::vector<BuildingRecord>{}, 0)));
  auto listing = std::make_shared<Listing>();
  listing->open = ids.size();
  listing->page = *page;
  listing->respond = std::move(respond);
  for (const BuildingId id : ids) {
    databases.with_building(id, [listing](Result<BuildingDatabase*> database) {
      if (!database) return listing->arrived(std::nullopt);
      auto record = (*database)->building();
      listing->arrived(record ? std::optional(std::move(*record)) : std::nullopt);
    });
  }
}

void create_building(DatabaseDirectory& databases, ServerControl& server, const Request& request, Respond respond) {
  auto building = parse_building(request.body);
  if (!building) return respond(problem(building.fault()));
  if (const auto known = known_pipeline(*building, server); !known) return respond(problem(known.fault()));
  databases.create_building(std::move(*building), [&databases, &server, respond](Result<BuildingRecord> created) {
    if (!created) return respond(problem(created.fault()));
    // Who reads 201 begins a session at once.
    server.building_made(created->id, [&databases, &server, id = created->id, respond] { answer_with_building(databases, server, id, 201, respond); });
  });
}

// Changes a record by `change`, unless If-Match names another state, and answers with the result.
void update_building(DatabaseDirectory& databases, ServerControl& server, BuildingId id, const Request& request,
                     std::function<void(BuildingRecord&)> change, Respond respond) {
  databases.with_building(id, [&databases, &server, id, request, change, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    auto record = (*database)->building();
    if (!record) return respond(problem(record.fault()));
    if (auto refused = changed_since(request, described(*record))) return respond(*std::move(refused));
    change(*record);
    if (const auto stored = (*database)->update(*record); !stored) return respond(problem(stored.fault()));
    server.building_changed(id);
    answer_with_building(databases, server, id, 200, respond);
  });
}

void replace_building(DatabaseDirectory& databases, ServerControl& server, BuildingId id, const Request& request, Respond respond) {
  auto building = parse_building(request.body);
  if (!building) return respond(problem(building.fault()));
  if (const auto known = known_pipeline(*building, server); !known) return respond(problem(known.fault()));
  update_building(databases, server, id, request,
                  [wanted = *building](BuildingRecord& record) {
                    record.name = wanted.name;
                    record.georeference = wanted.georeference;
                    record.magnetic_field = wanted.magnetic_field;
                    record.floors = wanted.floors;
                    record.pipeline = wanted.pipeline;
                    record.publication = wanted.publication;
                  },
                  std::move(respond));
}

}  // namespace

Result<BuildingId> building_in(const PathValues& path) {
  const std::string& text = path.at("building");
  BuildingId id;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id.value);
  if (error != std::errc{} || end != text.data() + text.size()) {
    return Fault{FaultCode::kUnknownBuilding, "building", "there is no such building"};
  }
  return id;
}

Result<std::uint64_t> id_in(const PathValues& path, const char* name) {
  const std::string& text = path.at(name);
  std::uint64_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc{} || end != text.data() + text.size() || id == 0 || id > static_cast<std::uint64_t>(INT64_MAX)) {
    return Fault{FaultCode::kNotFound, name, "there is no such " + std::string(name)};
  }
  return id;
}

Handler on_building(std::function<void(BuildingId, const Request&, Respond)> handler) {
  return [handler = std::move(handler)](const Request& request, const PathValues& path, Respond respond) {
    const auto id = building_in(path);
    if (!id) return respond(problem(id.fault()));
    handler(*id, request, std::move(respond));
  };
}

Handler on_existing(const DatabaseDirectory& databases, std::function<void(BuildingId, const Request&, Respond)> handler) {
  return on_building([&databases, handler = std::move(handler)](BuildingId id, const Request& request, Respond respond) {
    if (std::ranges::count(databases.buildings(), id) == 0) {
      return respond(problem({FaultCode::kUnknownBuilding, "building", "there is no such building for this key"}));
    }
    handler(id, request, std::move(respond));
  });
}

Response json_response(int status, std::string body) {
  Response response;
  response.status = status;
  response.body = std::move(body);
  return response;
}

void add_building_routes(Router& router, DatabaseDirectory& databases, ServerControl& server) {
  router.add({"GET", "/v1/buildings", Scope::kAdmin, "All buildings",
              [&](const Request& request, const PathValues&, Respond respond) { list_buildings(databases, request, std::move(respond)); }});
  router.add({"POST", "/v1/buildings", Scope::kAdmin, "Create a building",
              [&](const Request& request, const PathValues&, Respond respond) {
                create_building(databases, server, request, std::move(respond));
              }});
  router.add({"GET", "/v1/buildings/{building}", Scope::kObserve, "One building with its floors",
              on_building([&](BuildingId id, const Request&, Respond respond) {
                answer_with_building(databases, server, id, 200, std::move(respond));
              }),
              false, true});
  router.add({"PUT", "/v1/buildings/{building}", Scope::kAdmin, "Replace a building's description",
              on_building([&](BuildingId id, const Request& request, Respond respond) {
                replace_building(databases, server, id, request, std::move(respond));
              })});
  router.add({"PUT", "/v1/buildings/{building}/floors", Scope::kAdmin, "Replace the floors: outlines and walkable areas",
              on_building([&](BuildingId id, const Request& request, Respond respond) {
                auto floors = parse_floors(request.body);
                if (!floors) return respond(problem(floors.fault()));
                update_building(databases, server, id, request, [wanted = *floors](BuildingRecord& record) { record.floors = wanted; },
                                std::move(respond));
              })});
}

}  // namespace wayfuse
