#include <nlohmann/json.hpp>

#include "admin/api.hpp"
#include "admin/bearer_token.hpp"
#include "admin/session_token.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::json;

const double kLifeMost_s = seconds(SessionToken::kLifeMost);

Result<double> parse_lifetime_s(std::string_view text) {
  if (text.empty()) return kLifeMost_s;
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return Fault{FaultCode::kMalformed, "", "the body is not JSON"};
  if (!json.is_object()) return Fault{FaultCode::kWrongType, "", "the body must be a JSON object"};
  if (!json.contains("lifetime_s")) return kLifeMost_s;
  const Json& value = json["lifetime_s"];
  if (!value.is_number()) return Fault{FaultCode::kWrongType, "lifetime_s", "must be a number"};
  const double lifetime_s = value.get<double>();
  if (lifetime_s >= 1.0 && lifetime_s <= kLifeMost_s) return lifetime_s;
  return Fault{FaultCode::kOutOfRange, "lifetime_s", value.dump() + " is outside 1..900"};
}

void make_token(const KeyRing& keys, BuildingId building, const Request& request, Respond respond) {
  const std::string_view bearer = bearer_token(request);
  if (looks_like_session_token(bearer)) {
    return respond(problem({FaultCode::kNotAllowed, "authorization", "a session token makes no tokens: ask with a key"}));
  }
  const auto lifetime_s = parse_lifetime_s(request.body);
  if (!lifetime_s) return respond(problem(lifetime_s.fault()));
  const auto sealed = keys.session_token(bearer, building, from_seconds(*lifetime_s));
  if (!sealed) return respond(problem(sealed.fault()));
  Response response =
      json_response(201, Json{{"token", *sealed}, {"expires_in_s", *lifetime_s}, {"building", building.value}}.dump());
  response.headers["cache-control"] = "no-store";
  respond(std::move(response));
}

}  // namespace

void add_session_token_routes(Router& router, const DatabaseDirectory& databases, const KeyRing& keys) {
  router.add({"POST", "/v1/session-tokens", Scope::kTrack, "Make a token for one phone's sessions in any building: tracking only, 15 minutes",
              [&](const Request& request, const PathValues&, Respond respond) { make_token(keys, {}, request, std::move(respond)); }});
  router.add({"POST", "/v1/buildings/{building}/session-tokens", Scope::kTrack, "Make one for this building alone",
              on_existing(databases, [&](BuildingId id, const Request& request, Respond respond) {
                make_token(keys, id, request, std::move(respond));
              })});
}

}  // namespace wayfuse
