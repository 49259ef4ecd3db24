#include <nlohmann/json.hpp>
#include <numbers>

#include "admin/json_field.hpp"
#include "admin/json_forms.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMostDays = 7.0;

const char* name_of(Integrity integrity) {
  switch (integrity) {
    case Integrity::kOk: return "ok";
    case Integrity::kDegraded: return "degraded";
    case Integrity::kSuspect: return "suspect";
  }
  return "suspect";
}

Json to_json(const FusedPosition& position) {
  Json json{{"x_m", position.place.point.x_m},
            {"y_m", position.place.point.y_m},
            {"floor", position.place.floor.value},
            {"radius68_m", position.radius68_m},
            {"radius95_m", position.radius95_m},
            {"covariance_m2", {position.covariance.xx_m2, position.covariance.xy_m2, position.covariance.yy_m2}},
            {"azimuth_deg", position.heading.azimuth_rad() / kDegree},
            {"speed_mps", position.speed_mps},
            {"radio_map_version", position.radio_map_version},
            {"integrity", name_of(position.integrity)}};
  if (position.geo) json["geo"] = {{"latitude_deg", position.geo->latitude_deg}, {"longitude_deg", position.geo->longitude_deg}};
  return json;
}

Json to_form(const ReadingExplained& reading) {
  Json json{{"bssid", to_string(reading.bssid)}, {"heard_dbm", reading.heard_dbm}};
  json["expected_dbm"] = reading.expected_dbm ? Json(*reading.expected_dbm) : Json();
  json["residual_db"] = reading.expected_dbm ? Json(*reading.residual_db()) : Json();
  json["surveyed_scans"] = reading.surveyed_scans;
  json["age_us"] = reading.age.count();
  if (!reading.rejected.empty()) json["why"] = reading.rejected;
  return json;
}

Json to_form(const Explanation& explanation) {
  const FusedPosition& position = explanation.position;
  Json used = Json::array(), rejected = Json::array(), votes = Json::array(), particles = Json::array();
  for (const ReadingExplained& reading : explanation.readings) (reading.rejected.empty() ? used : rejected).push_back(to_form(reading));
  for (const FloorProbability& vote : position.floors) votes.push_back({{"floor", vote.floor.value}, {"probability", vote.probability}});
  for (const auto& each : explanation.particles) particles.push_back({each.point.x_m, each.point.y_m, each.weight});
  return Json{{"tracked", explanation.tracked},
              {"building", position.building.value},
              {"pipeline", explanation.pipeline},
              {"position", to_json(position)},
              {"scan_age_us", position.from.scan_age.count()},
              {"steps_since_scan", position.from.steps_since_scan},
              {"gnss", position.from.gnss},
              {"surveyed_points_near", explanation.surveyed_points},
              {"used", std::move(used)},
              {"rejected", std::move(rejected)},
              {"floor_votes", std::move(votes)},
              {"integrity", {{"state", name_of(position.integrity)}, {"reasons", explanation.doubts}}},
              {"remarks", explanation.remarks},
              {"particles", std::move(particles)}};
}

Json to_form(const RecordingSummary& recording) {
  return {{"id", recording.id},
          {"building", recording.building.value},
          {"tracked", recording.tracked},
          {"device_model", recording.device_model},
          {"app", recording.app},
          {"pipeline", recording.pipeline},
          {"first_radio_map_version", recording.first_map},
          {"last_radio_map_version", recording.last_map},
          {"seed", std::to_string(recording.seed)},
          {"epoch", std::to_string(recording.epoch)},
          {"begun_at_us", recording.begun_at.time_since_epoch().count()},
          {"ended_at_us", recording.ended_at.time_since_epoch().count()},
          {"growing", recording.growing},
          {"from_the_start", recording.from_the_start},
          {"pieces_dropped", recording.pieces_dropped},
          {"samples", recording.samples},
          {"steps", recording.answers},
          {"bytes", recording.bytes}};
}

Json to_form(const ReplayStep& step) {
  Json json{{"step", step.number},
            {"time_us", step.at.time_since_epoch().count()},
            {"applied_through", step.applied_through},
            {"radio_map_version", step.map_version},
            {"said", step.said}};
  json["as_live"] = step.as_live ? Json(*step.as_live) : Json();
  if (step.no_position) json["no_position"] = step.no_position->cause;
  if (step.explanation) json["explanation"] = to_form(*step.explanation);
  return json;
}

}  // namespace

std::string to_json(const std::vector<SessionSummary>& sessions, const std::map<std::string, std::vector<std::string>>& zones,
                    bool coarse) {
  Json entries = Json::array();
  for (const SessionSummary& session : sessions) {
    Json json{{"tracked", session.tracked},
              {"building", session.building.value},
              {"device_model", session.device_model},
              {"app", session.app},
              {"pipeline", session.pipeline},
              {"since_us", session.since.time_since_epoch().count()},
              {"connected", session.connected},
              {"applied_through", session.applied_through}};
    const auto inside = zones.find(session.tracked);
    json["zones"] = inside != zones.end() ? inside->second : std::vector<std::string>();
    if (session.position && !coarse) json["position"] = to_json(*session.position);
    entries.push_back(std::move(json));
  }
  return Json{{"sessions", std::move(entries)}}.dump();
}

std::string to_json(const Explanation& explanation) { return to_form(explanation).dump(); }

std::string to_json(const RecordingState& state) {
  Json json{{"on", state.until.has_value()}};
  if (state.until) json["until_us"] = state.until->time_since_epoch().count();
  json["bytes"] = state.bytes;
  json["kept_s"] = seconds(state.kept);
  json["tracked"] = state.tracked;
  json["recordings"] = state.recordings;
  json["bytes_used"] = state.bytes_used;
  json["pieces_dropped"] = state.pieces_dropped;
  json["not_recorded"] = state.not_recorded;
  return json.dump();
}

std::string to_json(const RecordingSummary& recording) { return to_form(recording).dump(); }

std::string to_json(const std::vector<RecordingSummary>& recordings, std::optional<std::uint64_t> next) {
  Json entries = Json::array();
  for (const RecordingSummary& recording : recordings) entries.push_back(to_form(recording));
  Json json{{"recordings", std::move(entries)}};
  if (next) json["next"] = *next;
  return json.dump();
}

std::string to_json(const ReplayAnswer& answer, std::uint64_t recording, std::optional<std::uint64_t> map_version) {
  Json steps = Json::array();
  for (const ReplayStep& step : answer.page) steps.push_back(to_form(step));
  Json json{{"recording", recording}, {"pipeline", answer.pipeline}};
  json["radio_map_version"] = map_version ? Json(*map_version) : Json();
  json["as_it_was"] = answer.as_it_was;
  json["steps_in_all"] = answer.steps;
  json["differing"] = answer.differing;
  json["remarks"] = answer.remarks;
  json["steps"] = std::move(steps);
  if (!answer.page.empty() && answer.page.back().number < answer.steps) json["next"] = answer.page.back().number;
  return json.dump();
}

Result<RecordingOrder> parse_recording_order(std::string_view text) {
  return JsonField::reading([&] {
    const JsonField json = JsonField::object_in(text);
    RecordingOrder order;
    order.on_for = from_seconds(json.member("on_for_s").number(0.0, kMostDays * 86400.0));
    order.kept = from_seconds(json.number("kept_s", seconds(order.kept), 60.0, kMostDays * 86400.0));
    if (const auto bytes = json.maybe("bytes")) {
      order.bytes = static_cast<std::size_t>(bytes->whole(RecordingOrder::kLeastBytes, RecordingOrder::kMostBytes));
    }
    if (const auto tracked = json.maybe("tracked")) {
      for (const JsonField& each : tracked->list(100)) order.tracked.push_back(each.text(64));
    }
    return order;
  });
}

Result<ReplayQuestion> parse_replay_question(std::string_view text) {
  return JsonField::reading([&] {
    ReplayQuestion question;
    if (text.empty()) return question;
    const JsonField json = JsonField::object_in(text);
    question.pipeline = json.text("pipeline", "", 64);
    if (const auto version = json.maybe("radio_map_version")) question.map_version = static_cast<std::uint64_t>(version->whole(0, INT64_MAX));
    if (const auto after = json.maybe("after")) question.after = static_cast<std::uint64_t>(after->whole(0, INT64_MAX));
    if (const auto most = json.maybe("most")) question.most = static_cast<std::size_t>(most->whole(1, 200));
    if (const auto particles = json.maybe("particles")) question.particles = static_cast<std::size_t>(particles->whole(0, 500));
    return question;
  });
}

}  // namespace wayfuse
