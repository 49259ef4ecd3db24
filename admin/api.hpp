#pragma once

#include "admin/access.hpp"
#include "admin/router.hpp"
#include "admin/server_control.hpp"
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
void add_operation_routes(Router& router, ServerControl& server);
/// API keys: make (shown once), list, revoke.
void add_key_routes(Router& router, KeyRing& keys, const Clock& clock);
/// Session tokens: what a phone holds instead of a key.
void add_session_token_routes(Router& router, const KeyRing& keys);
/// The console's page and what it loads.
void add_console_routes(Router& router);

/// The building a path names; kUnknownBuilding where it is no number.
Result<BuildingId> building_in(const PathValues& path);
Response json_response(int status, std::string body);

}  // namespace wayfuse
