#include <charconv>

#include "admin/api.hpp"
#include "admin/map_forms.hpp"
#include "admin/maps_api.hpp"

namespace wayfuse {
namespace {

Result<FloorOrdinal> floor_in(const Request& request) {
  const auto found = request.query.find("floor");
  if (found == request.query.end()) return Fault{FaultCode::kMissingField, "floor", "is required: ?floor=ORDINAL"};
  std::int32_t ordinal = 0;
  const char* end = found->second.data() + found->second.size();
  const auto [stop, error] = std::from_chars(found->second.data(), end, ordinal);
  if (error != std::errc{} || stop != end || ordinal < -100 || ordinal > 300) {
    return Fault{FaultCode::kOutOfRange, "floor", "'" + found->second + "' is no ordinal in -100..300"};
  }
  return FloorOrdinal{ordinal};
}

/// Answers with the JSON of what `ask` finds on the floor asked for.
template <typename Ask>
Handler on_floor(Ask ask) {
  return on_building([ask](BuildingId id, const Request& request, Respond respond) {
    const auto floor = floor_in(request);
    if (!floor) return respond(problem(floor.fault()));
    ask(id, *floor, [respond](const auto& found) { respond(found ? json_response(200, to_json(*found)) : problem(found.fault())); });
  });
}

void list_access_points(MapControl& maps, BuildingId id, Respond respond) {
  maps.access_points(id, [respond](Result<std::vector<AccessPointView>> views) {
    if (!views) return respond(problem(views.fault()));
    std::vector<std::string> items;
    for (const AccessPointView& view : *views) items.push_back(to_json(view));
    respond(json_response(200, items_json(items)));
  });
}

void trust(MapControl& maps, const PathValues& path, const Request& request, Respond respond) {
  const auto id = building_in(path);
  if (!id) return respond(problem(id.fault()));
  const auto bssid = parse_bssid(path.at("bssid"));
  if (!bssid) return respond(problem({FaultCode::kNotFound, "bssid", "there is no such access point"}));
  const auto wanted = parse_trust(request.body);
  if (!wanted) return respond(problem(wanted.fault()));
  maps.trust_access_point(*id, *bssid, *wanted, [respond](Result<AccessPointView> view) {
    respond(view ? json_response(200, to_json(*view)) : problem(view.fault()));
  });
}

}  // namespace

void add_radio_routes(Router& router, MapControl& maps) {
  router.add({"GET", "/v1/buildings/{building}/accuracy", Scope::kObserve, "Coverage and expected error of a floor, from the survey alone",
              on_floor([&maps](BuildingId id, FloorOrdinal floor, auto done) { maps.expected_accuracy(id, floor, done); })});
  router.add({"GET", "/v1/buildings/{building}/survey-plan", Scope::kObserve, "What to walk next, and what it is worth",
              on_floor([&maps](BuildingId id, FloorOrdinal floor, auto done) { maps.survey_plan(id, floor, done); })});
  router.add({"GET", "/v1/buildings/{building}/access-points", Scope::kAdmin, "Access points as live traffic hears them, against the survey",
              on_building([&maps](BuildingId id, const Request&, Respond respond) { list_access_points(maps, id, std::move(respond)); })});
  router.add({"PUT", "/v1/buildings/{building}/access-points/{bssid}", Scope::kAdmin, "Trust an access point: auto, always or never",
              [&maps](const Request& request, const PathValues& path, Respond respond) { trust(maps, path, request, std::move(respond)); }});
}

}  // namespace wayfuse
