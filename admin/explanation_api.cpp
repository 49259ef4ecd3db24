#include "admin/api.hpp"
#include "admin/json_forms.hpp"

namespace wayfuse {

void add_explanation_routes(Router& router, const SessionControl& sessions) {
  const Handler explain = [&](const Request&, const PathValues& path, Respond respond) {
    const BuildingId building = path.contains("building") ? *building_in(path) : BuildingId{};  // the router refused what is no number
    const auto explanation = sessions.explain(path.at("tracked"), building);
    if (!explanation) return respond(problem(explanation.fault()));
    Response response = json_response(200, to_json(*explanation));
    response.headers["cache-control"] = "no-store";
    respond(std::move(response));
  };
  router.add({"GET", "/v1/sessions/{tracked}/explain", Scope::kAdmin, "Why a session's newest position is where it is", explain, true});
  router.add({"GET", "/v1/buildings/{building}/sessions/{tracked}/explain", Scope::kAdmin, "The same, of a session in this building", explain,
              true});
}

}  // namespace wayfuse
