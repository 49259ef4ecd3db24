#include "admin/plan/plan.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "admin/plan/laying_down.hpp"

namespace wayfuse {
namespace {

using Severity = PlanCheck::Severity;
using Names = std::set<std::string, std::less<>>;

constexpr std::size_t kMostChecks = 500;

// What plans in the wild call the things we know: our own export, OpenStreetMap's Simple Indoor Tagging, IMDF, malls' files.
const Names kOutlineNames = {"outline", "floor", "level", "footprint", "storey"};
const Names kRoomNames = {"room", "unit", "shop", "store", "office", "area"};
const Names kWalkableNames = {"walkable", "walkway", "corridor", "hallway", "aisle"};
const Names kWallNames = {"wall", "walls"};
const Names kOpeningNames = {"opening", "door", "entrance"};
const Names kIgnoredNames = {"zone", "point", "reference_point", "venue", "address", "building", "amenity", "anchor", "occupant", "fixture", "kiosk",
                             "section", "geofence", "relationship", "detail"};
// IMDF 1.0 unit categories; what is neither is a room.
const Names kWalkableUnits = {"walkway", "walkway.island", "lobby", "ramp", "stairs", "steps", "escalator", "elevator", "movingwalkway", "footbridge",
                              "platform", "terrace", "unenclosedarea", "waitingroom", "parking", "road"};
const Names kSolidUnits = {"brick", "column", "concretewall", "drywall", "glasswall", "structure", "opentobelow", "vegetation", "wood"};

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<FloorOrdinal> whole(const std::string& text) {
  const auto value = number_of(text);
  if (!value || *value != std::floor(*value) || *value < -100 || *value > 300) return std::nullopt;
  return FloorOrdinal{static_cast<std::int32_t>(*value)};
}

// The floor a feature names; `floor_num` is counted without a zero, as on lifts of malls.
std::optional<FloorOrdinal> floor_named_by(const Feature& feature) {
  if (const auto ordinal = whole(feature.property({"floor", "ordinal", "level"}))) return ordinal;
  const auto counted = whole(feature.property({"floor_num"}));
  if (!counted) return std::nullopt;
  return counted->value > 0 ? FloorOrdinal{counted->value - 1} : counted;
}

/// Floors in the making, ascending.
class Floors {
 public:
  PlanFloor& at(FloorOrdinal ordinal) {
    PlanFloor& floor = floors_[ordinal];
    floor.ordinal = ordinal;
    return floor;
  }
  bool has(FloorOrdinal ordinal) const { return floors_.contains(ordinal); }
  std::vector<PlanFloor> take() {
    std::vector<PlanFloor> floors;
    for (auto& [ordinal, floor] : floors_) {
      if (floor.label.empty()) floor.label = std::to_string(ordinal.value);
      floors.push_back(std::move(floor));
    }
    return floors;
  }

 private:
  std::map<FloorOrdinal, PlanFloor> floors_;
};

void add_rings(Polygon& to, Polygon from) {
  for (Ring& ring : from.rings) to.rings.push_back(std::move(ring));
}

// ---------------------------------------------------------------- GeoJSON

enum class Kind { kOutline, kRoom, kWalkable, kWall, kOpening, kIgnored };

// By what the feature says of itself; an area that says nothing is a room, a line a wall.
Kind kind_of(const Feature& feature) {
  for (const char* name : {"wayfuse", "kind", "feature_type", "indoor", "type", "category", "door"}) {
    const std::string value = feature.property({name}, true);
    if (value.empty()) continue;
    if (std::string_view(name) == "door" && value != "no") return Kind::kOpening;
    if (kOutlineNames.contains(value)) return Kind::kOutline;
    if (kWalkableNames.contains(value) || kWalkableUnits.contains(value)) return Kind::kWalkable;
    if (kWallNames.contains(value)) return Kind::kWall;
    if (kOpeningNames.contains(value)) return Kind::kOpening;
    if (kIgnoredNames.contains(value)) return Kind::kIgnored;
    if (kRoomNames.contains(value)) return Kind::kRoom;
  }
  return feature.polygons.empty() ? Kind::kWall : Kind::kRoom;
}

class GeojsonPlan {
 public:
  GeojsonPlan(const FeatureCollection& file, const PlanOptions& options, Plan& plan)
      : file_(file), options_(options), plan_(plan), laying_(LayingDown::of({&file}, options, plan)) {}

  Result<void> read() {
    for (const Feature& feature : file_.features) {
      if (!feature.has_geometry) continue;
      if (feature.polygons.empty() && feature.lines.empty()) {
        ++points_;
        continue;
      }
      const auto floor = options_.floor ? options_.floor : floor_named_by(feature) ? floor_named_by(feature) : only_floor_;
      if (!floor) return Fault{FaultCode::kMissingField, feature.where, "names no floor (floor, ordinal, level or floor_num): say ?floor="};
      take(feature, kind_of(feature), floors_.at(*floor));
      if (!options_.floor && floor_named_by(feature) && &feature == &file_.features.front()) only_floor_ = floor;
    }
    if (points_ > 0) plan_.check(Severity::kNote, "points", "", std::to_string(points_) + " features are points and were passed over");
    plan_.floors = floors_.take();
    return {};
  }

 private:
  void take(const Feature& feature, Kind kind, PlanFloor& floor) {
    // In files that name nothing the first area is the floor.
    const bool first_area = floor.outline.rings.empty() && floor.rooms.empty() && !feature.polygons.empty();
    if (kind == Kind::kRoom && first_area && !names_kinds()) kind = Kind::kOutline;
    switch (kind) {
      case Kind::kOutline: {
        add_rings(floor.outline, laying_.polygon(feature, plan_));
        const std::string label = feature.property({"label", "floor_label", "short_name", "name"});
        if (floor.label.empty()) floor.label = options_.floor && !options_.label.empty() ? options_.label : label.substr(0, 64);
        break;
      }
      case Kind::kWalkable: floor.walkable.push_back(laying_.polygon(feature, plan_)); break;
      case Kind::kRoom: {
        Polygon polygon = laying_.polygon(feature, plan_);
        if (polygon.rings.empty()) break;
        floor.rooms.push_back({feature.property({"name", "display", "ref"}), feature.property({"category", "room"}), feature.where, std::move(polygon)});
        break;
      }
      case Kind::kWall:
        for (const RawLine& line : feature.lines) floor.walls.push_back(laying_.line(line));
        for (const auto& polygon : feature.polygons) {
          for (const RawLine& ring : polygon) floor.walls.push_back(laying_.line(ring));
        }
        break;
      case Kind::kOpening:
        for (const RawLine& line : feature.lines) floor.openings.push_back(laying_.line(line));
        break;
      case Kind::kIgnored: break;
    }
  }

  bool names_kinds() const {
    return std::ranges::any_of(file_.features, [](const Feature& feature) { return !feature.polygons.empty() && kind_of(feature) == Kind::kOutline; });
  }

  const FeatureCollection& file_;
  const PlanOptions& options_;
  Plan& plan_;
  const LayingDown laying_;
  Floors floors_;
  std::optional<FloorOrdinal> only_floor_;  ///< what the first feature says where the others are silent
  std::size_t points_ = 0;
};

// ---------------------------------------------------------------- IMDF

class ImdfPlan {
 public:
  ImdfPlan(const std::map<std::string, std::string>& files, const PlanOptions& options, Plan& plan)
      : files_(files), options_(options), plan_(plan) {}

  Result<void> read() {
    if (!files_.contains("manifest.json")) plan_.check(Severity::kWarning, "manifest", "manifest.json", "is missing: IMDF wants one");
    for (const char* type : {"level", "unit", "opening"}) {
      const auto file = files_.find(std::string(type) + ".geojson");
      if (file == files_.end()) continue;
      auto read = read_features(file->second, type);
      if (!read) return read.fault();
      collections_[type] = *std::move(read);
    }
    if (collections_["level"].features.empty()) return Fault{FaultCode::kMissingField, "level.geojson", "an IMDF archive has levels"};
    const LayingDown laying = LayingDown::of({&collections_["level"], &collections_["unit"], &collections_["opening"]}, options_, plan_);
    for (const Feature& level : collections_["level"].features) take_level(level, laying);
    for (const Feature& unit : collections_["unit"].features) take_unit(unit, laying);
    for (const Feature& opening : collections_["opening"].features) take_opening(opening, laying);
    plan_.floors = floors_.take();
    return {};
  }

 private:
  void take_level(const Feature& level, const LayingDown& laying) {
    const auto ordinal = whole(level.property({"ordinal"}));
    if (!ordinal) return plan_.check(Severity::kError, "ordinal", level.where, "properties.ordinal: a whole number expected");
    if (level.id.empty()) plan_.check(Severity::kWarning, "id", level.where, "has no id: no unit can belong to it");
    if (floors_.has(*ordinal)) {
      plan_.check(Severity::kWarning, "ordinal", level.where, "another level has ordinal " + std::to_string(ordinal->value) + "; they make one floor");
    }
    PlanFloor& floor = floors_.at(*ordinal);
    if (floor.label.empty()) floor.label = level.property({"short_name", "name"}).substr(0, 64);
    add_rings(floor.outline, laying.polygon(level, plan_));
    by_level_[level.id] = *ordinal;
  }

  PlanFloor* floor_of(const Feature& feature) {
    const auto level = by_level_.find(feature.property({"level_id"}));
    if (level != by_level_.end()) return &floors_.at(level->second);
    plan_.check(Severity::kWarning, "level", feature.where, "properties.level_id names no level of this archive; left out");
    return nullptr;
  }

  void take_unit(const Feature& unit, const LayingDown& laying) {
    PlanFloor* floor = floor_of(unit);
    Polygon polygon = floor ? laying.polygon(unit, plan_) : Polygon();
    if (polygon.rings.empty()) return;
    const std::string category = unit.property({"category"}, true);
    if (kSolidUnits.contains(category)) {
      floor->solids.push_back(std::move(polygon));
    } else if (kWalkableUnits.contains(category)) {
      floor->walkable.push_back(std::move(polygon));
    } else {
      floor->rooms.push_back({unit.property({"name", "alt_name"}), category, unit.where, std::move(polygon)});
    }
  }

  void take_opening(const Feature& opening, const LayingDown& laying) {
    PlanFloor* floor = floor_of(opening);
    if (!floor) return;
    for (const RawLine& line : opening.lines) floor->openings.push_back(laying.line(line));
  }

  const std::map<std::string, std::string>& files_;
  const PlanOptions& options_;
  Plan& plan_;
  std::map<std::string, FeatureCollection> collections_;
  std::map<std::string, FloorOrdinal> by_level_;
  Floors floors_;
};

}  // namespace

void Plan::check(PlanCheck::Severity severity, std::string code, std::string feature, std::string detail) {
  if (checks.size() == kMostChecks && severity != Severity::kError) return;
  checks.push_back({severity, std::move(code), std::move(feature), std::move(detail)});
}

bool Plan::sound() const { return std::ranges::none_of(checks, [](const PlanCheck& check) { return check.severity == Severity::kError; }); }

Result<Plan> read_plan(std::string_view file, const PlanOptions& options) {
  Plan plan;
  Result<void> read;
  if (file.starts_with("PK")) {
    plan.format = "imdf";
    const auto files = unzip(file);
    if (!files) return files.fault();
    read = ImdfPlan(*files, options, plan).read();
  } else {
    plan.format = "geojson";
    const auto features = read_features(file, "features");
    if (!features) return features.fault();
    read = GeojsonPlan(*features, options, plan).read();
  }
  if (!read) return read.fault();
  if (plan.floors.empty()) return Fault{FaultCode::kMissingField, "features", "no area or line among them: there is no floor to store"};
  return plan;
}

}  // namespace wayfuse
