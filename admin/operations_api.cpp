#include "admin/api.hpp"
#include "admin/json_forms.hpp"

namespace wayfuse {
namespace {

// Health and metrics stand where probes and scrapers look for them.
void add_probe_routes(Router& router, ServerControl& server) {
  router.add({"GET", "/healthz", Scope::kPublic, "The process lives",
              [](const Request&, const PathValues&, Respond respond) { respond(json_response(200, R"({"healthy":true})")); }});
  router.add({"GET", "/readyz", Scope::kPublic, "The server takes sessions; otherwise why not",
              [&](const Request&, const PathValues&, Respond respond) {
                const Readiness readiness = server.readiness();
                respond(json_response(readiness.ready ? 200 : 503, to_json(readiness)));
              }});
  router.add({"GET", "/v1/version", Scope::kPublic, "Version and protocols",
              [](const Request&, const PathValues&, Respond respond) {
                respond(json_response(200, R"({"version":")" WAYFUSE_VERSION
                                           R"(","protocols":["wayfuse.v1.cbor","wayfuse.v1.json"]})"));
              }});
  router.add({"GET", "/metrics", Scope::kObserve, "Prometheus metrics",
              [&](const Request&, const PathValues&, Respond respond) {
                Response response;
                response.content_type = "text/plain; version=0.0.4; charset=utf-8";
                response.body = server.metrics();
                respond(std::move(response));
              },
              false, true});
}

}  // namespace

void add_operation_routes(Router& router, const DatabaseDirectory& databases, ServerControl& server, const ZoneControl& zones) {
  add_probe_routes(router, server);
  router.add({"GET", "/v1/sessions", Scope::kAdmin, "Live sessions of all buildings",
              [&](const Request&, const PathValues&, Respond respond) {
                respond(json_response(200, to_json(server.sessions({}), zones.zones_by_phone({}), false)));
              },
              true});
  router.add({"GET", "/v1/buildings/{building}/sessions", Scope::kObserve, "Live sessions in one building and the zones they are in",
              on_existing(databases, [&](BuildingId id, const Request& request, Respond respond) {
                respond(json_response(200, to_json(server.sessions(id), zones.zones_by_phone(id), request.coarse)));
              }),
              true, true});
  router.add({"GET", "/v1/parts", Scope::kObserve, "Every pipeline part with its settings, units and defaults",
              [&](const Request&, const PathValues&, Respond respond) { respond(json_response(200, to_json(server.parts()))); },
              false, true});
  router.add({"GET", "/v1/pipelines", Scope::kObserve, "Names of the pipeline presets",
              [&](const Request&, const PathValues&, Respond respond) {
                respond(json_response(200, names_to_json("pipelines", server.presets())));
              },
              false, true});
  router.add({"GET", "/v1/pipelines/{pipeline}", Scope::kObserve, "One preset: its parts and settings",
              [&](const Request&, const PathValues& path, Respond respond) {
                auto preset = server.preset_json(path.at("pipeline"));
                respond(preset ? json_response(200, std::move(*preset)) : problem(preset.fault(), 404));
              },
              false, true});
}

}  // namespace wayfuse
