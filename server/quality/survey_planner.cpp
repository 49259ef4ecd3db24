#include "server/quality/survey_planner.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <numeric>

#include "server/quality/metrics.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kMostWalks = 5;
constexpr double kLongest_m = 60.0;
constexpr double kUnsurveyed_m = 4.0;      // farther than this from the survey is new ground
constexpr double kReach_m = 15.0;          // cells farther from a path gain nothing worth counting
constexpr double kSetOff_m = 10.0;         // what it costs to begin a walk at all
constexpr std::size_t kStarts = 24;        // places a walk may begin from, looked at each round
constexpr double kLeastGain = 0.005;       // of the mean error, that a walk must be worth
constexpr double kStraight_m = 1.0;        // a path is drawn this exactly

using Cells = std::vector<std::size_t>;

class Planner {
 public:
  Planner(const AccuracyModel& model, AccuracyField field) : model_(model), field_(std::move(field)) {}

  SurveyPlan plan(FloorOrdinal floor) {
    SurveyPlan plan{floor, {}, {}};
    if (std::ranges::count(field_.inside, 1) == 0) return plan;
    plan.median_now_m = median();
    while (plan.walks.size() < kMostWalks) {
      const Cells best = best_path();
      const double before = mean();
      if (best.empty() || gain(best) < kLeastGain * before * static_cast<double>(std::ranges::count(field_.inside, 1))) break;
      const double farthest_m = farthest(best);
      walk(best);
      plan.walks.push_back({drawn(best), length(best), median(), why(farthest_m, before)});
    }
    return plan;
  }

 private:
  double error(std::size_t cell) const {
    return model_.error_m(static_cast<double>(field_.nearest_m[cell]), static_cast<double>(field_.radius_m[cell]));
  }
  /// With a survey `away_m` from the cell: it is covered like other ground.
  double error_beside(std::size_t cell, double away_m) const {
    const double now = static_cast<double>(field_.nearest_m[cell]);
    if (away_m >= now) return error(cell);
    const double radius_m = std::min(static_cast<double>(field_.radius_m[cell]), model_.typical_radius_m());
    return std::min(error(cell), model_.error_m(away_m, radius_m));
  }
  std::vector<double> errors() const {
    std::vector<double> all;
    for (std::size_t cell = 0; cell < field_.inside.size(); ++cell) {
      if (field_.inside[cell]) all.push_back(error(cell));
    }
    return all;
  }
  double median() const { return percentile(errors(), 0.5); }
  double mean() const { return wayfuse::mean(errors()); }

  template <typename Visit>
  void around(std::size_t cell, Visit visit) const {
    const auto columns = static_cast<std::size_t>(field_.columns);
    const std::size_t column = cell % columns, row = cell / columns;
    if (column > 0) visit(cell - 1);
    if (column + 1 < columns) visit(cell + 1);
    if (row > 0) visit(cell - columns);
    if (row + 1 < static_cast<std::size_t>(field_.rows)) visit(cell + columns);
  }

  bool is_new(std::size_t cell) const { return field_.inside[cell] && static_cast<double>(field_.nearest_m[cell]) > kUnsurveyed_m; }

  /// Breadth first over new ground; answers the farthest cell and the way to it.
  Cells way_from(std::size_t start) const {
    std::vector<std::size_t> from(field_.inside.size(), field_.inside.size());
    std::deque<std::size_t> open = {start};
    from[start] = start;
    std::size_t last = start;
    const auto most = static_cast<std::size_t>(kLongest_m / field_.cell_m);
    std::vector<std::size_t> depth(field_.inside.size(), 0);
    while (!open.empty()) {
      last = open.front();
      open.pop_front();
      if (depth[last] == most) break;
      around(last, [&](std::size_t next) {
        if (!is_new(next) || from[next] != field_.inside.size()) return;
        from[next] = last;
        depth[next] = depth[last] + 1;
        open.push_back(next);
      });
    }
    Cells way = {last};
    while (way.back() != start) way.push_back(from[way.back()]);
    return way;
  }

  /// Of several places to begin: the ones farthest from the survey, not beside each other.
  Cells starts() const {
    Cells fresh;
    for (std::size_t cell = 0; cell < field_.inside.size(); ++cell) {
      if (is_new(cell)) fresh.push_back(cell);
    }
    std::ranges::stable_sort(fresh, std::greater{}, [&](std::size_t cell) { return error(cell); });
    Cells chosen;
    for (const std::size_t cell : fresh) {
      if (chosen.size() == kStarts) break;
      const bool apart = std::ranges::all_of(chosen, [&](std::size_t other) { return distance_m(field_.middle(cell), field_.middle(other)) > kReach_m; });
      if (apart) chosen.push_back(cell);
    }
    return chosen;
  }

  Cells best_path() const {
    Cells best;
    double most = 0.0;
    for (const std::size_t start : starts()) {
      // From one end of the new ground to the other.
      Cells way = way_from(way_from(start).front());
      const double worth = gain(way) / (length(way) + kSetOff_m);
      if (worth <= most) continue;
      most = worth;
      best = std::move(way);
    }
    return best;
  }

  template <typename Visit>
  void beside(const Cells& way, Visit visit) const {
    for (std::size_t cell = 0; cell < field_.inside.size(); ++cell) {
      if (!field_.inside[cell]) continue;
      double away_m = kReach_m;
      for (const std::size_t step : way) away_m = std::min(away_m, distance_m(field_.middle(step), field_.middle(cell)));
      if (away_m < kReach_m) visit(cell, away_m);
    }
  }
  double gain(const Cells& way) const {
    double sum = 0.0;
    beside(way, [&](std::size_t cell, double away_m) { sum += error(cell) - error_beside(cell, away_m); });
    return sum;
  }
  void walk(const Cells& way) {
    beside(way, [&](std::size_t cell, double away_m) {
      if (away_m >= static_cast<double>(field_.nearest_m[cell])) return;
      field_.nearest_m[cell] = static_cast<float>(away_m);
      field_.radius_m[cell] = std::min(field_.radius_m[cell], static_cast<float>(model_.typical_radius_m()));
    });
  }
  double length(const Cells& way) const { return static_cast<double>(way.size() - 1) * field_.cell_m; }
  double farthest(const Cells& way) const {
    double most_m = 0.0;
    for (const std::size_t cell : way) most_m = std::max(most_m, static_cast<double>(field_.nearest_m[cell]));
    return most_m;
  }

  /// Corners only (Douglas and Peucker 1973).
  std::vector<BuildingPoint> drawn(const Cells& way) const {
    std::vector<BuildingPoint> points;
    for (const std::size_t cell : way) points.push_back(field_.middle(cell));
    std::vector<std::uint8_t> kept(points.size(), 0);
    kept.front() = kept.back() = 1;
    simplify(points, 0, points.size() - 1, kept);
    std::vector<BuildingPoint> corners;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (kept[i]) corners.push_back(points[i]);
    }
    return corners;
  }
  void simplify(const std::vector<BuildingPoint>& points, std::size_t first, std::size_t last, std::vector<std::uint8_t>& kept) const {
    double most_m = field_.cell_m * kStraight_m;
    std::size_t corner = 0;
    const BuildingPoint a = points[first], b = points[last];
    const double chord_m = distance_m(a, b);
    for (std::size_t i = first + 1; i < last; ++i) {
      const double off_m = chord_m == 0.0 ? distance_m(points[i], a)
                                          : std::abs((b.x_m - a.x_m) * (a.y_m - points[i].y_m) - (a.x_m - points[i].x_m) * (b.y_m - a.y_m)) / chord_m;
      if (off_m <= most_m) continue;
      most_m = off_m;
      corner = i;
    }
    if (corner == 0) return;
    kept[corner] = 1;
    simplify(points, first, corner, kept);
    simplify(points, corner, last, kept);
  }

  std::string why(double farthest_m, double mean_before_m) const {
    char text[200];
    const char* more = farthest_m >= AccuracyModel::kFar_m - 0.01 ? "more than " : "up to ";
    std::snprintf(text, sizeof text, "ground %s%.0f m from any survey: the mean error to expect goes from %.2f to %.2f m", more, farthest_m,
                  mean_before_m, mean());
    return text;
  }

  const AccuracyModel& model_;
  AccuracyField field_;
};

}  // namespace

Result<SurveyPlan> plan_survey(const AccuracyModel& model, FloorOrdinal floor) {
  auto field = model.field(floor);
  if (!field) return field.fault();
  return Planner(model, *std::move(field)).plan(floor);
}

}  // namespace wayfuse
