#include "admin/map_forms.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "admin/json_field.hpp"
#include "db/content_hash.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kReasonBytes = 1024;

std::int64_t microseconds(UnixTime time) { return time.time_since_epoch().count(); }

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
template <typename T>
Json value_or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json quality_of(const PooledQuality& quality) {
  if (quality.walks == 0) return nullptr;
  return {{"walks", quality.walks},
          {"asked", quality.asked},
          {"instants", quality.instants},
          {"mean_m", quality.mean_m},
          {"median_m", quality.median_m},
          {"p90_m", quality.p90_m},
          {"floor_hit", quality.floor_hit},
          {"in68", quality.in68},
          {"in95", quality.in95},
          {"error_quantiles_m", quality.error_quantiles_m}};
}

Json quality_of(const std::optional<MapQuality>& quality) {
  if (!quality) return nullptr;
  return {{"asked", quality->asked},         {"instants", quality->instants}, {"mean_m", quality->mean_m},
          {"median_m", quality->median_m},   {"p90_m", quality->p90_m},       {"floor_hit", quality->floor_hit},
          {"in68", quality->in68},           {"in95", quality->in95}};
}

Json place_of(BuildingPoint point) { return Json::array({point.x_m, point.y_m}); }

// An empty body says nothing, which is allowed where everything has a standard.
JsonField body_of(std::string_view json) {
  const bool empty = json.find_first_not_of(" \t\r\n") == std::string_view::npos;
  return JsonField::object_in(empty ? "{}" : json);
}

}  // namespace

std::string to_json(const RadioMapRecord& map, bool live, const std::vector<MapQuality>& measured) {
  Json recipe = Json::parse(map.recipe, nullptr, false);
  if (!recipe.is_object()) recipe = Json::object();
  return Json{{"version", map.version},
              {"live", live},
              {"survey_version", map.survey_version},
              {"built_at_us", microseconds(map.built_at)},
              {"sha256", hex(map.sha256)},
              {"bytes", map.bytes},
              {"points", recipe.value("points", std::uint64_t{0})},
              {"devices", recipe.value("devices", Json::array())},
              {"recipe", recipe},
              {"quality", quality_of(pool(measured))}}
      .dump();
}

std::string to_json(const Publication& publication) {
  return Json{{"id", publication.id},
              {"version", publication.version},
              {"act", publication.act == Publication::Act::kPromoted ? "promoted" : "rolled_back"},
              {"at_us", microseconds(publication.at)},
              {"by_key", publication.by_key},
              {"reason", publication.reason}}
      .dump();
}

std::string to_json(const QualityWalkRecord& walk) {
  return Json{{"id", walk.id},
              {"name", walk.name},
              {"device_model", walk.device_model},
              {"recorded_at_us", microseconds(walk.recorded_at)},
              {"sha256", hex(walk.sha256)},
              {"bytes", walk.bytes}}
      .dump();
}

std::string to_json(const MapComparisonView& comparison) {
  Json walks = Json::array();
  for (const MapComparisonView::Walk& walk : comparison.walks) {
    walks.push_back({{"id", walk.id}, {"name", walk.name}, {"candidate", quality_of(walk.candidate)}, {"live", quality_of(walk.in_force)}});
  }
  return Json{{"version", comparison.version},
              {"live", value_or_null(comparison.live)},
              {"pipeline", comparison.pipeline},
              {"verdict", comparison.verdict},
              {"reasons", comparison.reasons},
              {"remarks", comparison.remarks},
              {"mean_difference_m", number_or_null(comparison.difference_m)},
              {"mean_difference_low_m", number_or_null(comparison.low_m)},
              {"mean_difference_high_m", number_or_null(comparison.high_m)},
              {"candidate_quality", quality_of(comparison.candidate)},
              {"live_quality", quality_of(comparison.in_force)},
              {"walks", std::move(walks)}}
      .dump();
}

std::string to_json(const ExpectedAccuracy& accuracy) {
  Json expected = Json::array();
  for (const auto& cell : accuracy.expected_m) expected.push_back(cell ? Json(std::round(*cell * 100.0) / 100.0) : Json(nullptr));
  return Json{{"floor", accuracy.floor.value},
              {"origin_x_m", accuracy.origin_x_m},
              {"origin_y_m", accuracy.origin_y_m},
              {"cell_m", accuracy.cell_m},
              {"columns", accuracy.columns},
              {"rows", accuracy.rows},
              {"median_m", value_or_null(accuracy.median_m)},
              {"basis", accuracy.basis},
              {"points", accuracy.points},
              {"expected_m", std::move(expected)}}
      .dump();
}

std::string to_json(const SurveyPlan& plan) {
  Json walks = Json::array();
  for (const SurveyPlan::Walk& walk : plan.walks) {
    Json path = Json::array();
    for (const BuildingPoint& point : walk.path) path.push_back(place_of(point));
    walks.push_back({{"length_m", walk.length_m}, {"median_after_m", walk.median_after_m}, {"why", walk.why}, {"path", std::move(path)}});
  }
  return Json{{"floor", plan.floor.value}, {"median_now_m", value_or_null(plan.median_now_m)}, {"walks", std::move(walks)}}.dump();
}

std::string to_json(const AccessPointView& view) {
  const AccessPointRecord& record = view.record;
  Json resurvey = Json::array();
  for (const Place& place : view.resurvey) resurvey.push_back({{"x_m", place.point.x_m}, {"y_m", place.point.y_m}, {"floor", place.floor.value}});
  return Json{{"bssid", to_string(record.bssid)},
              {"state", to_string(record.state)},
              {"trust", to_string(record.trust)},
              {"quarantined", record.distrusted()},
              {"on_map", view.on_map},
              {"reason", record.reason},
              {"heard_sessions", record.heard_sessions},
              {"last_heard_us", record.last_heard_at ? Json(microseconds(*record.last_heard_at)) : Json(nullptr)},
              {"distance_m", value_or_null(record.distance_m)},
              {"change_db", value_or_null(record.change_db)},
              {"resurvey", std::move(resurvey)}}
      .dump();
}

std::string items_json(const std::vector<std::string>& items, std::uint64_t next) {
  std::string json = R"({"items":[)";
  for (std::size_t i = 0; i < items.size(); ++i) json += (i == 0 ? "" : ",") + items[i];
  json += "]";
  if (next != 0) json += R"(,"next":)" + std::to_string(next);
  return json + "}";
}

Result<MapPromotion> parse_promotion(std::string_view json) {
  return JsonField::reading([&] {
    const JsonField whole = body_of(json);
    MapPromotion promotion;
    promotion.reason = whole.text("reason", "", kReasonBytes);
    if (const auto expected = whole.maybe("expected_live")) promotion.expected_live = static_cast<std::uint64_t>(expected->whole(0, INT64_MAX));
    promotion.override_gate = whole.flag("override", false);
    if (promotion.override_gate && promotion.reason.empty()) {
      throw JsonField::Broken{{FaultCode::kMissingField, "reason", "an override needs a reason"}};
    }
    return promotion;
  });
}

Result<std::string> parse_reason(std::string_view json) {
  return JsonField::reading([&] { return body_of(json).text("reason", "", kReasonBytes); });
}

Result<AccessPointTrust> parse_trust(std::string_view json) {
  return JsonField::reading([&] {
    const JsonField trust = body_of(json).member("trust");
    for (const AccessPointTrust known : {AccessPointTrust::kAuto, AccessPointTrust::kAlways, AccessPointTrust::kNever}) {
      if (trust.text(16) == to_string(known)) return known;
    }
    trust.refuse(FaultCode::kUnknownName, "must be auto, always or never");
  });
}

}  // namespace wayfuse
