#include "server/quality/accuracy_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "server/quality/metrics.hpp"
#include "server/quality/survey_walks.hpp"

namespace wayfuse {
namespace {

constexpr double kWorst_m = 40.0;          // an error beyond says "lost", not how far
constexpr double kSurroundings_m = 5.0;    // Gaussian sigma over which conditions are alike
constexpr double kMargin_m = 4.0;
constexpr double kOnSurvey_m = 3.0;
constexpr double kUndrawn_m = 10.0;        // without a plan: ground this near a point is taken for ground
constexpr int kMostCells = 250'000;
constexpr double kMadeUpApart_m = 5.0;     // between the made-up places of fit()

std::size_t fold_of(std::size_t track) { return track % AccuracyModel::kFolds; }

double nearest_m(const std::vector<BuildingPoint>& survey, BuildingPoint point) {
  double least_m = AccuracyModel::kFar_m;
  for (const BuildingPoint& other : survey) least_m = std::min(least_m, distance_m(other, point));
  return least_m;
}

std::vector<BuildingPoint> points_of(const Site& site, FloorOrdinal floor) {
  std::vector<BuildingPoint> points;
  for (const ReferencePoint& point : site.survey) {
    if (point.place.floor == floor) points.push_back(point.place.point);
  }
  return points;
}

/// A box that grows.
struct Bounds {
  double low_x = INFINITY, low_y = INFINITY, high_x = -INFINITY, high_y = -INFINITY;
  void add(BuildingPoint point) {
    low_x = std::min(low_x, point.x_m), high_x = std::max(high_x, point.x_m);
    low_y = std::min(low_y, point.y_m), high_y = std::max(high_y, point.y_m);
  }
  void add(const Polygon& polygon) {
    for (const Ring& ring : polygon.rings) {
      for (const BuildingPoint& point : ring) add(point);
    }
  }
};

bool is_inside(const Floor* floor, BuildingPoint point, double nearest_survey_m) {
  if (floor && !floor->walkable.empty()) {
    return std::ranges::any_of(floor->walkable, [&](const Polygon& area) { return contains(area, point); });
  }
  if (floor && !floor->outline.rings.empty()) return contains(floor->outline, point);
  return nearest_survey_m <= kUndrawn_m;
}

/// Solves the 3 x 3 normal equations over the columns chosen, the others held at 0; absent when they are singular.
std::optional<std::array<double, 3>> solve(const std::array<std::array<double, 3>, 3>& a, const std::array<double, 3>& b, unsigned chosen) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < 3; ++i) {
    if (chosen >> i & 1u) rows.push_back(i);
  }
  const std::size_t n = rows.size();
  std::vector<std::vector<double>> m(n, std::vector<double>(n + 1));
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = 0; c < n; ++c) m[r][c] = a[rows[r]][rows[c]];
    m[r][n] = b[rows[r]];
  }
  for (std::size_t k = 0; k < n; ++k) {
    const auto pivot = std::max_element(m.begin() + static_cast<std::ptrdiff_t>(k), m.end(),
                                        [k](const auto& x, const auto& y) { return std::abs(x[k]) < std::abs(y[k]); });
    if (std::abs((*pivot)[k]) < 1e-9) return std::nullopt;
    std::swap(m[k], *pivot);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == k) continue;
      const double factor = m[r][k] / m[k][k];
      for (std::size_t c = k; c <= n; ++c) m[r][c] -= factor * m[k][c];
    }
  }
  std::array<double, 3> solution{};
  for (std::size_t r = 0; r < n; ++r) solution[rows[r]] = m[r][n] / m[r][r];
  return solution;
}

}  // namespace

Result<std::shared_ptr<const AccuracyModel>> AccuracyModel::learn(std::shared_ptr<const Site> site, const PipelineSpec& pipeline) {
  std::shared_ptr<AccuracyModel> model(new AccuracyModel(std::move(site)));
  const std::vector<SurveyedTrack> tracks = tracks_of_survey(*model->site_);
  for (std::size_t fold = 0; fold < kFolds && tracks.size() >= kFolds; ++fold) {
    if (const auto checked = model->check_fold(fold, pipeline, tracks); !checked) return checked.fault();
  }
  if (model->places_.size() >= kFewestPlaces) model->fit();
  return std::shared_ptr<const AccuracyModel>(std::move(model));
}

// Prepares the pipeline without the fold's tracks and follows them.
Result<void> AccuracyModel::check_fold(std::size_t fold, const PipelineSpec& pipeline, const std::vector<SurveyedTrack>& tracks) {
  std::vector<std::uint8_t> left_out(site_->survey.size(), 0);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    if (fold_of(t) != fold) continue;
    for (const std::size_t point : tracks[t].points) left_out[point] = 1;
  }
  auto rest = std::make_shared<Site>(*site_);
  rest->correctors.clear();
  rest->survey.clear();
  for (std::size_t i = 0; i < site_->survey.size(); ++i) {
    if (!left_out[i]) rest->survey.push_back(site_->survey[i]);
  }
  const auto factory = assemble(pipeline, rest);
  if (!factory) return factory.fault();
  std::map<FloorOrdinal, std::vector<BuildingPoint>> survey;
  for (const ReferencePoint& point : rest->survey) survey[point.place.floor].push_back(point.place.point);
  const std::size_t stride = std::max<std::size_t>(1, tracks.size() / kMostTracks);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    if (fold_of(t) != fold || t / kFolds % stride != 0) continue;
    const SurveyedTrack& walk = tracks[t];
    for (const TrackAnswer& answer : replay(**factory, walk.track, walk.ask_at, Random(t + 1))) {
      const auto truth = truth_at(walk.track.marks, answer.time);
      if (!truth || !answer.position) continue;
      const bool right_floor = answer.position->place.floor == truth->floor;
      const double error_m = right_floor ? distance_m(answer.position->place.point, truth->point) : kWorst_m;
      places_.push_back({*truth, std::min(error_m, kWorst_m), nearest_m(survey[truth->floor], truth->point),
                         std::min(answer.position->radius68_m, kWorst_m)});
    }
  }
  return {};
}

// Least squares of the error on (1, distance, radius) without negative weights: of all subsets the best that has none. A survey
// in even steps has never been far from itself: some made-up places say that the error grows with the distance as it usually does.
void AccuracyModel::fit() {
  std::array<std::array<double, 3>, 3> a{};
  std::array<double, 3> b{};
  Checked usual;
  for (const Checked& place : places_) {
    const auto share = 1.0 / static_cast<double>(places_.size());
    usual.error_m += share * place.error_m, usual.nearest_m += share * place.nearest_m, usual.radius_m += share * place.radius_m;
  }
  std::vector<Checked> known = places_;
  for (double away_m = 0.0; away_m <= kFar_m; away_m += kMadeUpApart_m) {
    known.push_back({{}, std::max(0.0, usual.error_m + per_metre_ * (away_m - usual.nearest_m)), away_m, usual.radius_m});
  }
  for (const Checked& place : known) {
    const std::array<double, 3> x = {1.0, place.nearest_m, place.radius_m};
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) a[r][c] += x[r] * x[c];
      b[r] += x[r] * place.error_m;
    }
  }
  double least = INFINITY;
  for (unsigned chosen = 1; chosen < 8; ++chosen) {
    const auto weights = solve(a, b, chosen);
    if (!weights || std::ranges::any_of(*weights, [](double weight) { return weight < 0.0; })) continue;
    double misfit = 0.0;
    for (const Checked& place : known) {
      const double expected = (*weights)[0] + (*weights)[1] * place.nearest_m + (*weights)[2] * place.radius_m;
      misfit += (place.error_m - expected) * (place.error_m - expected);
    }
    if (misfit >= least) continue;
    least = misfit;
    base_m_ = (*weights)[0], per_metre_ = (*weights)[1], per_radius_ = (*weights)[2];
  }
  std::vector<double> shares, radii_m;
  for (const Checked& place : places_) {
    shares.push_back(place.error_m / std::max(0.1, base_m_ + per_metre_ * place.nearest_m + per_radius_ * place.radius_m));
    if (place.nearest_m <= kOnSurvey_m) radii_m.push_back(place.radius_m);
  }
  median_share_ = percentile(std::move(shares), 0.5);
  if (!radii_m.empty()) typical_radius_m_ = percentile(std::move(radii_m), 0.5);
}

Result<AccuracyField> AccuracyModel::field(FloorOrdinal ordinal) const {
  const auto floor = std::ranges::find(site_->floors, ordinal, &Floor::ordinal);
  const Floor* drawn = floor != site_->floors.end() ? &*floor : nullptr;
  const std::vector<BuildingPoint> survey = points_of(*site_, ordinal);
  Bounds bounds;
  for (const BuildingPoint& point : survey) bounds.add(point);
  if (drawn) {
    bounds.add(drawn->outline);
    for (const Polygon& area : drawn->walkable) bounds.add(area);
  }
  if (bounds.low_x > bounds.high_x) {
    return Fault{FaultCode::kNotFound, "floor", "floor " + std::to_string(ordinal.value) + " was neither surveyed nor drawn"};
  }
  AccuracyField field;
  field.origin_x_m = bounds.low_x - kMargin_m;
  field.origin_y_m = bounds.low_y - kMargin_m;
  const double width_m = bounds.high_x - bounds.low_x + 2.0 * kMargin_m, height_m = bounds.high_y - bounds.low_y + 2.0 * kMargin_m;
  while (width_m / field.cell_m * (height_m / field.cell_m) > kMostCells) field.cell_m *= 2.0;
  field.columns = static_cast<int>(std::ceil(width_m / field.cell_m));
  field.rows = static_cast<int>(std::ceil(height_m / field.cell_m));
  const auto cells = static_cast<std::size_t>(field.columns) * static_cast<std::size_t>(field.rows);
  field.points.assign(cells, 0);
  for (const BuildingPoint& point : survey) {
    const auto column = static_cast<std::size_t>((point.x_m - field.origin_x_m) / field.cell_m);
    const auto row = static_cast<std::size_t>((point.y_m - field.origin_y_m) / field.cell_m);
    field.points[row * static_cast<std::size_t>(field.columns) + column]++;
  }
  field.inside.assign(cells, 0);
  field.nearest_m.assign(cells, static_cast<float>(kFar_m));
  for (std::size_t cell = 0; cell < cells; ++cell) {
    field.nearest_m[cell] = static_cast<float>(nearest_m(survey, field.middle(cell)));
    field.inside[cell] = is_inside(drawn, field.middle(cell), static_cast<double>(field.nearest_m[cell]));
  }
  smooth(ordinal, field);
  return field;
}

// The radius stated around every cell, from the checked places about it.
void AccuracyModel::smooth(FloorOrdinal floor, AccuracyField& field) const {
  field.radius_m.assign(field.inside.size(), static_cast<float>(typical_radius_m_));
  std::vector<const Checked*> here;
  for (const Checked& place : places_) {
    if (place.place.floor == floor) here.push_back(&place);
  }
  for (std::size_t cell = 0; cell < field.inside.size(); ++cell) {
    if (!field.inside[cell]) continue;
    const BuildingPoint middle = field.middle(cell);
    double mass = 1.0, radius_m = typical_radius_m_;
    for (const Checked* place : here) {
      const double away_m = distance_m(place->place.point, middle);
      if (away_m > 3.0 * kSurroundings_m) continue;
      const double weight = std::exp(-0.5 * away_m * away_m / (kSurroundings_m * kSurroundings_m));
      mass += weight;
      radius_m += weight * place->radius_m;
    }
    field.radius_m[cell] = static_cast<float>(radius_m / mass);
  }
}

Result<ExpectedAccuracy> AccuracyModel::expected(FloorOrdinal floor) const {
  const auto field = this->field(floor);
  if (!field) return field.fault();
  ExpectedAccuracy accuracy{floor, field->origin_x_m, field->origin_y_m, field->cell_m, field->columns, field->rows, field->points, {}, {}, basis()};
  std::vector<double> errors_m;
  for (std::size_t cell = 0; cell < field->inside.size(); ++cell) {
    accuracy.expected_m.emplace_back();
    if (!field->inside[cell]) continue;
    errors_m.push_back(error_m(static_cast<double>(field->nearest_m[cell]), static_cast<double>(field->radius_m[cell])));
    accuracy.expected_m.back() = errors_m.back();
  }
  if (!errors_m.empty()) accuracy.median_m = percentile(std::move(errors_m), 0.5);
  return accuracy;
}

std::string AccuracyModel::basis() const {
  char text[256];
  if (places_.size() < kFewestPlaces) {
    std::snprintf(text, sizeof text, "general figures: only %zu places of the survey could be checked against the rest of it", places_.size());
  } else {
    std::snprintf(text, sizeof text, "%zu places of the survey, each checked against a map without it: %.2f m + %.2f a metre off the survey + %.2f x stated radius",
                  places_.size(), median_share_ * base_m_, median_share_ * per_metre_, median_share_ * per_radius_);
  }
  return text;
}

}  // namespace wayfuse
