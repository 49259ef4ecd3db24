#pragma once

#include "admin/access.hpp"
#include "admin/recording_control.hpp"
#include "admin/router.hpp"
#include "admin/server_control.hpp"
#include "admin/session_control.hpp"
#include "admin/webhook_control.hpp"
#include "admin/zone_control.hpp"
#include "db/database_directory.hpp"
#include "wayfuse/proto/time.hpp"

/// The admin API's routes, one function a group of resources. Handlers are plain: no sockets, no threads of their own.
///
/// What is passed by reference must outlive the router.
namespace wayfuse {

/// Buildings and their floors: create, list, read, replace.
void add_building_routes(Router& router, DatabaseDirectory& databases, ServerControl& server);
/// Reference points: upload, page through, export as CSV and GeoJSON; transmitters.
void add_survey_routes(Router& router, DatabaseDirectory& databases, ServerControl& server);
/// Health, readiness, version, metrics, live sessions, pipelines and their parts.
void add_operation_routes(Router& router, const DatabaseDirectory& databases, ServerControl& server, const ZoneControl& zones);
/// Why one session's newest position is where it is.
void add_explanation_routes(Router& router, const SessionControl& sessions);
/// Recordings of sessions: order, list, fetch, erase, replay.
void add_recording_routes(Router& router, RecordingControl& recordings);
/// Zones: list, make, replace, remove; who is in them; their events as server-sent events.
void add_zone_routes(Router& router, DatabaseDirectory& databases, ZoneControl& zones, const Access& access, const Clock& clock);
/// Runs a task some time later, off the caller's thread.
using RunLater = std::function<void(std::function<void()>)>;
/// Floor plans from GeoJSON and IMDF, georeference by control points, floor images.
void add_plan_routes(Router& router, DatabaseDirectory& databases, ServerControl& server, ZoneControl& zones, RunLater run);
/// Webhooks for zone events, their state and dead letters.
void add_webhook_routes(Router& router, DatabaseDirectory& databases, WebhookControl& webhooks, const Clock& clock);
/// A building's data as a whole: backup, restore, verification, export, erasure, removal; the audit.
void add_data_routes(Router& router, DatabaseDirectory& databases, ServerControl& server, ZoneControl& zones, WebhookControl& webhooks,
                     const Clock& clock);
/// API keys: make (shown once), list, revoke.
void add_key_routes(Router& router, KeyRing& keys, const Clock& clock);
/// Session tokens: what a phone holds instead of a key.
void add_session_token_routes(Router& router, const DatabaseDirectory& databases, const KeyRing& keys);
/// The API's description, OpenAPI 3.1, as a document and as a page to read.
void add_openapi_routes(Router& router);
/// The console's page and what it loads.
void add_console_routes(Router& router);

/// The building a path names; kUnknownBuilding where it is no number.
Result<BuildingId> building_in(const PathValues& path);
/// Wraps a handler that works on the building its path names.
Handler on_building(std::function<void(BuildingId, const Request&, Respond)> handler);
/// The same where the handler asks the store for nothing: a building that is not there is kUnknownBuilding all the same.
Handler on_existing(const DatabaseDirectory& databases, std::function<void(BuildingId, const Request&, Respond)> handler);
/// The number at `name` in a path; kNotFound where it is none.
Result<std::uint64_t> id_in(const PathValues& path, const char* name);
Response json_response(int status, std::string body);

}  // namespace wayfuse
