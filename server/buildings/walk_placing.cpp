#include "server/buildings/walk_placing.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "db/content_hash.hpp"
#include "wayfuse/proto/codec.hpp"
#include "wayfuse/proto/scan_splitter.hpp"

namespace wayfuse {
namespace {

constexpr double kLeastShape_m = 1.0;      // a way shorter than this has no direction worth turning
constexpr double kMostStretch = 2.0;
constexpr double kMostWound = 3.0;         // walked this many times the distance covered: the shape is mostly error
constexpr double kOntoWalkable_m = 3.0;
constexpr double kDrift = 0.05;            // of the distance to the nearer mark, that the place is uncertain by

/// Dead reckoning along a walk, from anywhere, against any axes.
class Way {
 public:
  explicit Way(std::vector<MotionReport> motion) {
    std::ranges::stable_sort(motion, {}, &MotionReport::time);
    for (const MotionReport& report : motion) {
      if (knots_.empty()) knots_.push_back({report.time - report.interval, {}, 0.0});
      const Knot last = knots_.back();
      // A silence between two reports is a stand: the walker is where the last one ended.
      if (report.time - report.interval > last.time) knots_.push_back({report.time - report.interval, last.point, last.length_m});
      const double length_m = report.distance_m(), heading_rad = report.heading.radians();
      knots_.push_back({std::max(report.time, last.time),
                        {last.point.x_m + length_m * std::cos(heading_rad), last.point.y_m + length_m * std::sin(heading_rad)},
                        last.length_m + length_m});
    }
  }

  struct Knot {
    PhoneTime time;
    BuildingPoint point;
    double length_m = 0.0;
  };
  Knot at(PhoneTime time) const {
    if (knots_.empty()) return {time, {}, 0.0};
    const auto after = std::ranges::lower_bound(knots_, time, {}, &Knot::time);
    if (after == knots_.begin()) return {time, knots_.front().point, knots_.front().length_m};
    if (after == knots_.end()) return {time, knots_.back().point, knots_.back().length_m};
    const Knot& a = *(after - 1);
    const double share = seconds(time - a.time) / seconds(after->time - a.time);
    return {time,
            {a.point.x_m + share * (after->point.x_m - a.point.x_m), a.point.y_m + share * (after->point.y_m - a.point.y_m)},
            a.length_m + share * (after->length_m - a.length_m)};
  }

 private:
  std::vector<Knot> knots_;
};

struct Spot {
  Place place;
  double sigma_m = 0.0;
};

/// From one mark to the next.
class Leg {
 public:
  Leg(const Way& way, const WayPoint& from, const WayPoint& to)
      : way_(way), from_(from), to_(to), start_(way.at(from.time)), end_(way.at(to.time)) {
    const double vx = end_.point.x_m - start_.point.x_m, vy = end_.point.y_m - start_.point.y_m;
    const double wx = to.place.point.x_m - from.place.point.x_m, wy = to.place.point.y_m - from.place.point.y_m;
    const double felt_m = std::hypot(vx, vy), marked_m = std::hypot(wx, wy);
    walked_m_ = end_.length_m - start_.length_m;
    if (felt_m < kLeastShape_m || marked_m < kLeastShape_m || walked_m_ > kMostWound * felt_m) return;
    const double stretch = marked_m / felt_m;
    if (stretch > kMostStretch || stretch < 1.0 / kMostStretch) return;
    shaped_ = true;
    // The one turn and stretch that carry the felt way onto the marked one: w / v as complex numbers.
    along_ = (wx * vx + wy * vy) / (felt_m * felt_m);
    across_ = (wy * vx - wx * vy) / (felt_m * felt_m);
  }

  Spot at(PhoneTime time) const {
    const Way::Knot here = way_.at(time);
    const double walked_m = here.length_m - start_.length_m;
    const BuildingPoint a = from_.place.point, b = to_.place.point;
    const double share = walked_m_ > 0.0 ? walked_m / walked_m_ : seconds(time - from_.time) / seconds(to_.time - from_.time);
    BuildingPoint point{a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m)};
    if (shaped_) {
      const double dx = here.point.x_m - start_.point.x_m, dy = here.point.y_m - start_.point.y_m;
      point = {a.x_m + along_ * dx - across_ * dy, a.y_m + across_ * dx + along_ * dy};
    }
    const double from_mark_m = std::min(distance_m(point, a), distance_m(point, b));
    return {{point, from_.place.floor}, std::hypot(std::max(from_.sigma_m, to_.sigma_m), kDrift * from_mark_m)};
  }

 private:
  const Way& way_;
  const WayPoint& from_;
  const WayPoint& to_;
  Way::Knot start_, end_;
  double walked_m_ = 0.0;
  bool shaped_ = false;
  double along_ = 1.0, across_ = 0.0;
};

BuildingPoint nearest_on(BuildingPoint a, BuildingPoint b, BuildingPoint point) {
  const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m, square = dx * dx + dy * dy;
  const double along = square == 0.0 ? 0.0 : ((point.x_m - a.x_m) * dx + (point.y_m - a.y_m) * dy) / square;
  const double share = std::clamp(along, 0.0, 1.0);
  return {a.x_m + share * dx, a.y_m + share * dy};
}

BuildingPoint onto_walkable(BuildingPoint point, const Floor& floor) {
  if (floor.walkable.empty() || std::ranges::any_of(floor.walkable, [&](const Polygon& area) { return contains(area, point); })) return point;
  BuildingPoint nearest = point;
  double least_m = kOntoWalkable_m;
  for (const Polygon& area : floor.walkable) {
    for (const Ring& ring : area.rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const BuildingPoint candidate = nearest_on(ring[i], ring[(i + 1) % ring.size()], point);
        if (distance_m(candidate, point) < least_m) {
          least_m = distance_m(candidate, point);
          nearest = candidate;
        }
      }
    }
  }
  return nearest;
}

struct WalkRecording {
  std::vector<WayPoint> marks;
  std::vector<MotionReport> motion;
  std::vector<RssScan> scans;
};

WalkRecording joined(std::span<const SurveyWalk> parts) {
  WalkRecording walk;
  for (const SurveyWalk& part : parts) {
    walk.marks.insert(walk.marks.end(), part.marks.begin(), part.marks.end());
    walk.motion.insert(walk.motion.end(), part.motion.begin(), part.motion.end());
    walk.scans.insert(walk.scans.end(), part.scans.begin(), part.scans.end());
  }
  std::ranges::stable_sort(walk.marks, {}, &WayPoint::time);
  std::ranges::stable_sort(walk.scans, {}, &RssScan::time);
  return walk;
}

std::optional<Spot> spot_at(const Way& way, std::span<const WayPoint> marks, std::span<const Floor> floors, PhoneTime time) {
  if (marks.size() < 2 || time < marks.front().time || time > marks.back().time) return std::nullopt;
  const auto to = std::ranges::upper_bound(marks.begin() + 1, marks.end() - 1, time, {}, &WayPoint::time);
  const WayPoint& from = *(to - 1);
  if (from.place.floor != to->place.floor || to->time <= from.time) return std::nullopt;
  Spot spot = Leg(way, from, *to).at(time);
  const auto floor = std::ranges::find(floors, spot.place.floor, &Floor::ordinal);
  if (floor != floors.end()) spot.place.point = onto_walkable(spot.place.point, *floor);
  return spot;
}

std::vector<SurveyBatch> batches_of(const std::string& walk, std::vector<ReferencePoint> points) {
  const std::string key = "placed." + hex(sha256(walk)).substr(0, 40) + ".";
  std::vector<SurveyBatch> batches;
  for (ReferencePoint& point : points) {
    if (batches.empty() || batches.back().points.size() == Limits::kPointsPerBatch) batches.push_back({key + std::to_string(batches.size()), {}});
    batches.back().points.push_back(std::move(point));
  }
  return batches;
}

Result<void> place_one(BuildingDatabase& database, const BuildingRecord& building, const std::string& walk) {
  const auto contents = database.walk_parts(walk);
  if (!contents) return contents.fault();
  std::vector<SurveyWalk> parts;
  for (const std::string& content : *contents) {
    auto message = decode_client_message(content, Encoding::kCbor);
    if (!message) return message.fault();
    if (auto* part = std::get_if<SurveyWalk>(&*message)) parts.push_back(std::move(*part));
  }
  const auto batches = batches_of(walk, place_walk(parts, building.floors));
  if (!batches.empty()) {
    for (const auto& answer : database.store(batches)) {
      // Placed before a break, by an older program perhaps: what is there stays.
      if (!answer && answer.fault().code != FaultCode::kIdempotencyConflict) return answer.fault();
    }
  }
  return database.mark_placed(walk);
}

}  // namespace

std::vector<ReferencePoint> place_walk(std::span<const SurveyWalk> parts, std::span<const Floor> floors) {
  std::vector<ReferencePoint> points;
  if (parts.empty()) return points;
  WalkRecording walk = joined(parts);
  const Way way(std::move(walk.motion));
  const SurveyWalk& first = parts.front();
  ScanSplitter splitter;
  for (const RssScan& scan : walk.scans) {
    for (HeardTogether& heard : splitter.split(scan)) {
      const auto spot = spot_at(way, walk.marks, floors, heard.middle);
      if (!spot) continue;
      const UnixTime at = first.wall_time + (heard.scan.time - first.phone_time);
      points.push_back({spot->place, spot->sigma_m, first.device_model, first.walk, at, {std::move(heard.scan)}});
    }
  }
  return points;
}

Result<void> place_recorded_walks(BuildingDatabase& database) {
  const auto walks = database.walks_to_place();
  if (!walks) return walks.fault();
  if (walks->empty()) return {};
  const auto building = database.building();
  if (!building) return building.fault();
  for (const std::string& walk : *walks) {
    if (const auto placed = place_one(database, *building, walk); !placed) return placed;
  }
  return {};
}

}  // namespace wayfuse
