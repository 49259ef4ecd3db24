#include "admin/api.hpp"
#include "admin/json_forms.hpp"
#include "admin/query_values.hpp"

namespace wayfuse {
namespace {

Response private_json(int status, std::string body) {
  Response response = json_response(status, std::move(body));
  response.headers["cache-control"] = "no-store";
  return response;
}

using OnRecording = std::function<void(std::uint64_t id, BuildingId building, const Request&, Respond)>;

// Of a path with a recording in it, below a building or not.
Handler on_recording(OnRecording handler) {
  return [handler = std::move(handler)](const Request& request, const PathValues& path, Respond respond) {
    const BuildingId building = path.contains("building") ? *building_in(path) : BuildingId{};  // the router refused what is no number
    const auto id = id_in(path, "recording");
    if (!id) return respond(problem(id.fault()));
    handler(*id, building, request, std::move(respond));
  };
}

// A building's order and its list.
void add_order_routes(Router& router, RecordingControl& recordings) {
  router.add({"GET", "/v1/buildings/{building}/recording", Scope::kAdmin, "Whether sessions are recorded here, and what room they take",
              on_building([&](BuildingId building, const Request&, Respond respond) {
                const auto state = recordings.state(building);
                state ? respond(private_json(200, to_json(*state))) : respond(problem(state.fault()));
              })});
  router.add({"PUT", "/v1/buildings/{building}/recording", Scope::kAdmin, "Record sessions for a while, or stop",
              on_building([&](BuildingId building, const Request& request, Respond respond) {
                const auto order = parse_recording_order(request.body);
                if (!order) return respond(problem(order.fault()));
                const auto state = recordings.order(building, *order);
                state ? respond(private_json(200, to_json(*state))) : respond(problem(state.fault()));
              })});
  router.add({"GET", "/v1/buildings/{building}/recordings", Scope::kAdmin, "Recorded sessions",
              on_building([&](BuildingId building, const Request& request, Respond respond) {
                const auto page = page_in(request);
                if (!page) return respond(problem(page.fault()));
                const auto found = recordings.recordings(building, page->after, page->most + 1);
                if (!found) return respond(problem(found.fault()));
                auto listed = *found;
                const bool more = listed.size() > page->most;
                if (more) listed.pop_back();
                respond(private_json(200, to_json(listed, more ? std::optional(listed.back().id) : std::nullopt)));
              }),
              true});
  router.add({"DELETE", "/v1/buildings/{building}/recordings", Scope::kAdmin, "Erase recordings: of one phone, or all",
              on_building([&](BuildingId building, const Request& request, Respond respond) {
                const auto tracked = request.query.find("tracked");
                const auto erased = recordings.erase_all(building, tracked != request.query.end() ? tracked->second : "");
                if (!erased) return respond(problem(erased.fault()));
                respond(json_response(200, "{\"erased\":" + std::to_string(*erased) + "}"));
              })});
}

}  // namespace

void add_recording_routes(Router& router, RecordingControl& recordings) {
  add_order_routes(router, recordings);
  const Handler content = on_recording([&](std::uint64_t id, BuildingId building, const Request&, Respond respond) {
    const auto lines = recordings.content(id, building);
    if (!lines) return respond(problem(lines.fault()));
    Response response;
    response.content_type = "application/x-ndjson";
    response.headers["cache-control"] = "no-store";
    response.headers["content-disposition"] = "attachment; filename=\"recording-" + std::to_string(id) + ".jsonl\"";
    response.stream = *lines;
    respond(std::move(response));
  });
  const Handler erase = on_recording([&](std::uint64_t id, BuildingId building, const Request&, Respond respond) {
    const auto erased = recordings.erase(id, building);
    erased ? respond(json_response(204, "")) : respond(problem(erased.fault()));
  });
  const Handler replay = on_recording([&](std::uint64_t id, BuildingId building, const Request& request, Respond respond) {
    const auto question = parse_replay_question(request.body);
    if (!question) return respond(problem(question.fault()));
    recordings.replay(id, building, *question, [id, map = question->map_version, respond](Result<ReplayAnswer> answer) {
      answer ? respond(private_json(200, to_json(*answer, id, map))) : respond(problem(answer.fault()));
    });
  });
  for (const std::string below : {"/v1", "/v1/buildings/{building}"}) {
    const std::string what = below == "/v1" ? "" : ", in this building";
    router.add({"GET", below + "/recordings/{recording}", Scope::kAdmin, "What a session was fed, as JSON lines" + what, content, true});
    router.add({"DELETE", below + "/recordings/{recording}", Scope::kAdmin, "Erase a recording" + what, erase});
    router.add({"POST", below + "/recordings/{recording}/replay", Scope::kAdmin, "Live through a recording again, step by step" + what, replay});
  }
}

}  // namespace wayfuse
