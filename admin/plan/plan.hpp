#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// One thing the reader of a plan found: an error keeps the plan from being stored, a warning was mended or should be looked
/// at, a note says what was assumed.
struct PlanCheck {
  enum class Severity { kError, kWarning, kNote };
  Severity severity = Severity::kNote;
  std::string code;                      ///< stable: `open_ring`, `self_intersection`, `outside_floor`, `scale`, ..
  std::string feature;                   ///< where in the file; empty = the whole
  std::string detail;                    ///< in words, with places in metres of the building's frame
};

struct PlanRoom {
  std::string name;                      ///< empty = it has none
  std::string category;
  std::string feature;
  Polygon polygon;
};

/// One floor as a file describes it, in the building's frame.
struct PlanFloor {
  FloorOrdinal ordinal;
  std::string label;
  Polygon outline;
  std::vector<Polygon> walkable;         ///< areas the file calls walkable
  std::vector<PlanRoom> rooms;
  std::vector<Polygon> solids;           ///< columns, voids: never walked on, and no rooms
  std::vector<Polyline> openings;        ///< doors
  std::vector<Polyline> walls;           ///< lines the file calls walls
};

struct Plan {
  std::string format;                    ///< `geojson` or `imdf`
  std::optional<Georeference> georeference;   ///< the plan was laid down by; absent = plain metres
  std::vector<PlanFloor> floors;         ///< ascending
  std::vector<PlanCheck> checks;

  void check(PlanCheck::Severity severity, std::string code, std::string feature, std::string detail);
  bool sound() const;                    ///< no error among the checks
};

/// What a file does not say.
struct PlanOptions {
  std::optional<Georeference> georeference;   ///< the building's; absent = one is made: origin at the plan's south-west corner
  std::optional<FloorOrdinal> floor;          ///< of every feature; absent = each says its own
  std::string label;                          ///< of that floor; empty = the file's, else the ordinal
  enum class Coordinates { kGuess, kWgs84, kMercator, kLocal } coordinates = Coordinates::kGuess;
  bool rooms_walkable = false;                ///< phones are tracked into rooms; else rooms are closed
};

/// Reads a plan: a GeoJSON FeatureCollection or an IMDF 1.0 archive, told apart by their first bytes. Rings are closed, every
/// polygon is looked at; what could not be read at all is a fault, everything else is among the checks.
Result<Plan> read_plan(std::string_view file, const PlanOptions& options);

/// The floors to be stored: outline, walkable area, walls with gaps at the doors. Adds to the plan's checks.
std::vector<Floor> floors_of(Plan& plan, const PlanOptions& options);

}  // namespace wayfuse
