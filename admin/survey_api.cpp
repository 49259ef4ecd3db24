#include "admin/api.hpp"
#include "admin/json_forms.hpp"
#include "admin/query_values.hpp"
#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

constexpr std::uint32_t kPerExportStep = 500;

Result<PointQuery> point_query(const Request& request) {
  const auto page = page_in(request);
  if (!page) return page.fault();
  const auto floor = floor_in(request);
  if (!floor) return floor.fault();
  PointQuery query;
  query.after_id = page->after;
  query.most = page->most;
  query.floor = *floor;
  return query;
}

// The body is the protocol's own survey document: one form, one parser, one set of limits.
void upload(DatabaseDirectory& databases, ServerControl& server, BuildingId id, const Request& request, Respond respond) {
  auto message = decode_client_message(request.body, Encoding::kJson);
  if (!message) return respond(problem(message.fault()));
  auto* batch = std::get_if<SurveyBatch>(&*message);
  if (!batch) return respond(problem({FaultCode::kUnknownType, "type", "must be survey"}));
  databases.store(id, std::move(*batch), [&server, id, respond](Result<SurveyAck> ack) {
    if (!ack) return respond(problem(ack.fault()));
    server.building_changed(id);
    respond(json_response(200, to_json(*ack)));
  });
}

void page(DatabaseDirectory& databases, BuildingId id, const PointQuery& query, Respond respond) {
  databases.with_building(id, [query, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto points = (*database)->points(query);
    if (!points) return respond(problem(points.fault()));
    respond(json_response(200, to_json(*points, points->size() == query.most ? points->back().id : 0)));
  });
}

void list_uploads(DatabaseDirectory& databases, BuildingId id, const Request& request, Respond respond) {
  const auto page = page_in(request);
  if (!page) return respond(problem(page.fault()));
  databases.with_building(id, [page = *page, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto uploads = (*database)->uploads(page.after, page.most);
    if (!uploads) return respond(problem(uploads.fault()));
    respond(json_response(200, to_json(*uploads, uploads->size() == page.most ? uploads->back().id : 0)));
  });
}

// Calls `each` for every stored point in order of id.
Result<void> for_every_point(BuildingDatabase& database, PointQuery query, const std::function<void(const StoredPoint&)>& each) {
  query.most = kPerExportStep;
  for (;;) {
    const auto points = database.points(query);
    if (!points) return points.fault();
    for (const StoredPoint& point : *points) each(point);
    if (points->size() < query.most) return {};
    query.after_id = points->back().id;
  }
}

Response attachment(std::string content_type, const std::string& name, std::string body) {
  Response response;
  response.content_type = std::move(content_type);
  response.headers["content-disposition"] = "attachment; filename=\"" + name + "\"";
  response.body = std::move(body);
  return response;
}

void export_csv(DatabaseDirectory& databases, BuildingId id, const PointQuery& query, Respond respond) {
  databases.with_building(id, [id, query, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    std::string body = points_csv_header();
    const auto done = for_every_point(**database, query, [&](const StoredPoint& point) { body += to_csv(point); });
    if (!done) return respond(problem(done.fault()));
    respond(attachment("text/csv; charset=utf-8", "building-" + std::to_string(id.value) + "-points.csv", std::move(body)));
  });
}

void export_geojson(DatabaseDirectory& databases, BuildingId id, const PointQuery& query, Respond respond) {
  databases.with_building(id, [id, query, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto building = (*database)->building();
    if (!building) return respond(problem(building.fault()));
    if (!building->georeference) {
      return respond(problem({FaultCode::kConflict, "georeference", "the building has none yet, and GeoJSON is WGS84"}));
    }
    std::string body = R"({"type":"FeatureCollection","features":[)";
    const char* comma = "";
    const auto done = for_every_point(**database, query, [&](const StoredPoint& point) {
      body += comma + to_geojson_feature(point, *building->georeference);
      comma = ",\n";
    });
    if (!done) return respond(problem(done.fault()));
    respond(attachment("application/geo+json", "building-" + std::to_string(id.value) + "-points.geojson", body + "]}"));
  });
}

void list_transmitters(DatabaseDirectory& databases, BuildingId id, Respond respond) {
  databases.with_building(id, [respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto transmitters = (*database)->transmitters();
    if (!transmitters) return respond(problem(transmitters.fault()));
    respond(json_response(200, to_json(*transmitters)));
  });
}

using PointHandler = void (*)(DatabaseDirectory&, BuildingId, const PointQuery&, Respond);

Handler reading_points(DatabaseDirectory& databases, PointHandler handler) {
  return [&databases, handler](const Request& request, const PathValues& path, Respond respond) {
    const auto id = building_in(path);
    if (!id) return respond(problem(id.fault()));
    const auto query = point_query(request);
    if (!query) return respond(problem(query.fault()));
    handler(databases, *id, *query, std::move(respond));
  };
}

}  // namespace

void add_survey_routes(Router& router, DatabaseDirectory& databases, ServerControl& server) {
  router.add({"POST", "/v1/buildings/{building}/points", Scope::kSurvey, "Upload reference points: a survey document",
              [&](const Request& request, const PathValues& path, Respond respond) {
                const auto id = building_in(path);
                if (!id) return respond(problem(id.fault()));
                upload(databases, server, *id, request, std::move(respond));
              }});
  router.add({"GET", "/v1/buildings/{building}/points", Scope::kAdmin, "Reference points, a page at a time",
              reading_points(databases, page)});
  router.add({"GET", "/v1/buildings/{building}/points.csv", Scope::kAdmin, "All reference points, one row a reading",
              reading_points(databases, export_csv)});
  router.add({"GET", "/v1/buildings/{building}/points.geojson", Scope::kAdmin, "All reference points as GeoJSON",
              reading_points(databases, export_geojson)});
  router.add({"GET", "/v1/buildings/{building}/uploads", Scope::kSurvey, "Survey batches that are stored, a page at a time",
              on_building([&](BuildingId id, const Request& request, Respond respond) { list_uploads(databases, id, request, std::move(respond)); })});
  router.add({"GET", "/v1/buildings/{building}/transmitters", Scope::kAdmin, "Access points as the survey heard them",
              [&](const Request&, const PathValues& path, Respond respond) {
                const auto id = building_in(path);
                if (!id) return respond(problem(id.fault()));
                list_transmitters(databases, *id, std::move(respond));
              }});
}

}  // namespace wayfuse
