#include "admin/plan_forms.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

#include "admin/json_field.hpp"
#include "admin/json_forms.hpp"
#include "admin/plan/planar.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kMostControlPoints = 1000;

const char* name_of(PlanCheck::Severity severity) {
  switch (severity) {
    case PlanCheck::Severity::kError: return "error";
    case PlanCheck::Severity::kWarning: return "warning";
    case PlanCheck::Severity::kNote: return "note";
  }
  return "note";
}

Json checks_to_json(const std::vector<PlanCheck>& checks) {
  Json list = Json::array();
  for (const auto severity : {PlanCheck::Severity::kError, PlanCheck::Severity::kWarning, PlanCheck::Severity::kNote}) {
    for (const PlanCheck& check : checks) {
      if (check.severity != severity) continue;
      list.push_back({{"severity", name_of(check.severity)}, {"code", check.code}, {"feature", check.feature}, {"detail", check.detail}});
    }
  }
  return list;
}

Json georeference_to_json(const Georeference& georeference) {
  return {{"origin", {{"latitude_deg", georeference.origin.latitude_deg}, {"longitude_deg", georeference.origin.longitude_deg}}},
          {"y_axis_azimuth_deg", georeference.y_axis_azimuth_rad / kDegree}};
}

std::size_t doors_of(const Plan& plan, FloorOrdinal ordinal) {
  for (const PlanFloor& floor : plan.floors) {
    if (floor.ordinal == ordinal) return floor.openings.size();
  }
  return 0;
}

}  // namespace

Result<std::vector<ControlPoint>> parse_control_points(std::string_view json) {
  return JsonField::reading([&] {
    std::vector<ControlPoint> points;
    for (const JsonField& point : JsonField::object_in(json).member("control_points").list(kMostControlPoints)) {
      points.push_back({{point.member("x_m").number(-1e5, 1e5), point.member("y_m").number(-1e5, 1e5)}, point.geo_point()});
    }
    return points;
  });
}

std::string to_json(const GeoreferenceFit& fit, bool stored) {
  Json json{{"stored", stored}, {"georeference", georeference_to_json(fit.georeference)}, {"rms_m", fit.rms_m}, {"scale", fit.scale}};
  json["scale_x"] = fit.scale_x ? Json(*fit.scale_x) : Json(nullptr);
  json["scale_y"] = fit.scale_y ? Json(*fit.scale_y) : Json(nullptr);
  json["shear_deg"] = fit.shear_rad ? Json(*fit.shear_rad / kDegree) : Json(nullptr);
  json["control_points"] = Json::array();
  for (std::size_t i = 0; i < fit.residual_m.size(); ++i) {
    Json point{{"residual_m", fit.residual_m[i]}};
    point["without_it_m"] = i < fit.without_it_m.size() ? Json(fit.without_it_m[i]) : Json(nullptr);
    json["control_points"].push_back(std::move(point));
  }
  json["checks"] = checks_to_json(fit.checks);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_json(const Plan& plan, const std::vector<Floor>& floors, const std::vector<ZoneRecord>& zones, bool stored) {
  Json json{{"format", plan.format}, {"stored", stored}};
  json["georeference"] = plan.georeference ? georeference_to_json(*plan.georeference) : Json(nullptr);
  json["floors"] = Json::array();
  for (const Floor& floor : floors) {
    const auto drawn = std::ranges::find(plan.floors, floor.ordinal, &PlanFloor::ordinal);
    const double outline_m2 = planar::area_m2(floor.outline);
    json["floors"].push_back({{"ordinal", floor.ordinal.value},
                              {"label", floor.label},
                              {"outline_m2", outline_m2},
                              {"walkable_m2", floor.walkable.empty() ? outline_m2 : planar::area_m2(planar::united(floor.walkable))},
                              {"rooms", drawn != plan.floors.end() ? drawn->rooms.size() : 0},
                              {"doors", doors_of(plan, floor.ordinal)},
                              {"walls", floor.walls.size()}});
  }
  json["checks"] = checks_to_json(plan.checks);
  json["zones"] = Json::array();
  for (const ZoneRecord& zone : zones) json["zones"].push_back(Json::parse(to_json(zone)));
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_json(const FloorImage& image) {
  return Json{{"floor", image.floor.value},
              {"media_type", image.media_type},
              {"width_px", image.width_px},
              {"height_px", image.height_px},
              {"origin_x_m", image.origin.x_m},
              {"origin_y_m", image.origin.y_m},
              {"width_m", image.width_m},
              {"height_m", image.height_m},
              {"azimuth_deg", image.azimuth_rad / kDegree},
              {"bytes", image.content.size()}}
      .dump();
}

}  // namespace wayfuse
