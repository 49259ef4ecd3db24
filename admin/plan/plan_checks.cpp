#include <algorithm>
#include <cmath>

#include "admin/plan/plan.hpp"
#include "admin/plan/planar.hpp"

namespace wayfuse {
namespace {

using Severity = PlanCheck::Severity;

constexpr double kDoorReach_m = 0.5;       // a door this far from a wall still belongs to it
constexpr double kGap_m = 0.4;
constexpr double kLeastFloor_m2 = 20.0;
constexpr double kLongestFloor_m = 3000.0;
constexpr double kOverlap = 0.1;           // of the smaller room
constexpr double kOutsideWorthSaying = 0.05;

std::string number(double value, int digits = 1) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

struct Box {
  BuildingPoint low{1e300, 1e300};
  BuildingPoint high{-1e300, -1e300};
  bool meets(const Box& other) const {
    return low.x_m <= other.high.x_m && other.low.x_m <= high.x_m && low.y_m <= other.high.y_m && other.low.y_m <= high.y_m;
  }
};

Box box_of(const Polygon& polygon) {
  Box box;
  for (const Ring& ring : polygon.rings) {
    for (const BuildingPoint& p : ring) {
      box.low = {std::min(box.low.x_m, p.x_m), std::min(box.low.y_m, p.y_m)};
      box.high = {std::max(box.high.x_m, p.x_m), std::max(box.high.y_m, p.y_m)};
    }
  }
  return box;
}

std::string called(const PlanRoom& room) { return room.feature + (room.name.empty() ? "" : " '" + room.name + "'"); }

class FloorChecks {
 public:
  FloorChecks(Plan& plan, const PlanFloor& floor, const Polygon& outline) : plan_(plan), floor_(floor), outline_(outline), area_m2_(planar::area_m2(outline)) {}

  void run() {
    check_scale();
    check_rooms();
    check_overlaps();
    check_doors();
  }

 private:
  std::string here() const { return "floor " + std::to_string(floor_.ordinal.value); }

  void check_scale() {
    const Box box = box_of(outline_);
    const double width_m = box.high.x_m - box.low.x_m;
    const double height_m = box.high.y_m - box.low.y_m;
    const std::string size = number(width_m) + " x " + number(height_m) + " m, " + number(area_m2_, 0) + " m2";
    if (std::max(width_m, height_m) > kLongestFloor_m) {
      plan_.check(Severity::kError, "scale", here(), size + ": no building is that large; other units or coordinates than assumed?");
    } else if (area_m2_ < kLeastFloor_m2) {
      plan_.check(Severity::kError, "scale", here(), size + ": no floor is that small; other units or coordinates than assumed?");
    } else {
      plan_.check(Severity::kNote, "scale", here(), size);
    }
  }

  void check_rooms() {
    for (const PlanRoom& room : floor_.rooms) {
      const double inside = planar::share_within(room.polygon, outline_);
      if (inside >= 1 - kOutsideWorthSaying) continue;
      const auto severity = inside < kOutsideWorthSaying ? Severity::kError : Severity::kWarning;
      plan_.check(severity, "outside_floor", called(room), number(100 * (1 - inside), 0) + " % of it lies outside " + here());
    }
    for (const Polygon& walkable : floor_.walkable) {
      const double inside = planar::share_within(walkable, outline_);
      if (inside < 1 - kOutsideWorthSaying) {
        plan_.check(Severity::kWarning, "outside_floor", here(), number(100 * (1 - inside), 0) + " % of a walkable area lies outside its outline");
      }
    }
  }

  void check_overlaps() {
    std::vector<Box> boxes;
    for (const PlanRoom& room : floor_.rooms) boxes.push_back(box_of(room.polygon));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = i + 1; j < boxes.size(); ++j) {
        if (!boxes[i].meets(boxes[j])) continue;
        const Polygon& a = floor_.rooms[i].polygon;
        const Polygon& b = floor_.rooms[j].polygon;
        const double smaller = std::min(planar::area_m2(a), planar::area_m2(b));
        const double both = planar::area_m2(planar::both(a, b));
        if (both <= kOverlap * smaller) continue;
        plan_.check(Severity::kWarning, "overlap", called(floor_.rooms[i]), "shares " + number(both) + " m2 with " + called(floor_.rooms[j]));
      }
    }
  }

  void check_doors() {
    if (floor_.rooms.empty()) return;
    if (floor_.openings.empty()) return plan_.check(Severity::kNote, "no_doors", here(), "the plan has rooms and no doors: their walls are closed");
    std::size_t without = 0;
    for (const PlanRoom& room : floor_.rooms) {
      const bool has = std::ranges::any_of(floor_.openings, [&](const Polyline& door) { return planar::distance_m(room.polygon, door) <= kDoorReach_m; });
      if (has) continue;
      if (++without <= 20) plan_.check(Severity::kWarning, "no_door", called(room), "no door touches its walls");
    }
    if (without > 20) plan_.check(Severity::kWarning, "no_door", here(), std::to_string(without - 20) + " more rooms have no door");
  }

  Plan& plan_;
  const PlanFloor& floor_;
  const Polygon& outline_;
  const double area_m2_;
};

Polygon outline_of(Plan& plan, const PlanFloor& floor) {
  if (!floor.outline.rings.empty()) return floor.outline;
  std::vector<Polygon> parts = floor.walkable;
  for (const PlanRoom& room : floor.rooms) parts.push_back(room.polygon);
  plan.check(Severity::kWarning, "outline", "floor " + std::to_string(floor.ordinal.value), "no outline: taken as what its rooms and corridors cover");
  return planar::united(parts);
}

// Empty = everywhere inside the outline.
std::vector<Polygon> walkable_of(const PlanFloor& floor, const Polygon& outline, bool rooms_walkable) {
  std::vector<Polygon> open = floor.walkable;
  std::vector<Polygon> closed = floor.solids;
  for (const PlanRoom& room : floor.rooms) (rooms_walkable ? open : closed).push_back(room.polygon);
  const bool told = !floor.walkable.empty();
  if (!told && closed.empty()) return {};
  Polygon area = told ? planar::united(open) : outline;
  if (!closed.empty()) area = planar::without(area, planar::united(closed));
  // Where every corridor was taken for a room, an area without a place to stand would lose every phone.
  return area.rings.empty() ? std::vector<Polygon>() : std::vector<Polygon>{std::move(area)};
}

std::vector<Polyline> walls_of(const PlanFloor& floor, const Polygon& outline) {
  std::vector<Polyline> walls = floor.walls;
  if (floor.rooms.empty()) return walls;
  std::vector<Polygon> rooms = {outline};
  for (const PlanRoom& room : floor.rooms) rooms.push_back(room.polygon);
  for (Polyline& wall : planar::borders(rooms, floor.openings, kGap_m)) walls.push_back(std::move(wall));
  return walls;
}

}  // namespace

std::vector<Floor> floors_of(Plan& plan, const PlanOptions& options) {
  std::vector<Floor> floors;
  for (const PlanFloor& drawn : plan.floors) {
    Floor floor;
    floor.ordinal = drawn.ordinal;
    floor.label = drawn.label;
    floor.outline = outline_of(plan, drawn);
    FloorChecks(plan, drawn, floor.outline).run();
    floor.walkable = walkable_of(drawn, floor.outline, options.rooms_walkable);
    floor.walls = walls_of(drawn, floor.outline);
    floors.push_back(std::move(floor));
  }
  return floors;
}

}  // namespace wayfuse
