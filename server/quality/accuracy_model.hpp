#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "admin/map_control.hpp"
#include "server/pipeline/tracker.hpp"

namespace wayfuse {

/// Of one floor's cells, what the expected error follows from. Cells row by row.
struct AccuracyField {
  double origin_x_m = 0.0;
  double origin_y_m = 0.0;
  double cell_m = 2.0;
  int columns = 0;
  int rows = 0;
  std::vector<std::uint8_t> inside;      ///< phones can be there
  std::vector<std::uint32_t> points;     ///< reference points in the cell
  std::vector<float> nearest_m;          ///< to the survey, at most kFar_m
  std::vector<float> radius_m;           ///< 68 % radius the pipeline states there, smoothed

  BuildingPoint middle(std::size_t cell) const {
    const auto column = static_cast<int>(cell) % columns, row = static_cast<int>(cell) / columns;
    return {origin_x_m + (column + 0.5) * cell_m, origin_y_m + (row + 0.5) * cell_m};
  }
};

/// What error a phone will see where, learnt from the survey alone: no test walk is needed.
///
/// The survey's walks are taken out a quarter at a time; the building's own pipeline is prepared without them and follows them,
/// with the steps of an ordinary phone. So its error is known in many places, together with the distance to the nearest survey
/// that was left and the radius the pipeline stated. A line through those (least squares, no negative slope) says what error to
/// expect at a given distance and radius, the latter smoothed over the surroundings. Deterministic.
class AccuracyModel {
 public:
  static constexpr double kFar_m = 30.0;       ///< distances beyond say no more
  static constexpr std::size_t kFolds = 4;
  static constexpr std::size_t kMostTracks = 240;
  static constexpr std::size_t kFewestPlaces = 30;  ///< fewer: general figures, and `basis` says so

  static Result<std::shared_ptr<const AccuracyModel>> learn(std::shared_ptr<const Site> site, const PipelineSpec& pipeline);

  Result<ExpectedAccuracy> expected(FloorOrdinal floor) const;
  Result<AccuracyField> field(FloorOrdinal floor) const;
  /// Median error to expect under these conditions, m.
  double error_m(double nearest_m, double radius_m) const {
    return median_share_ * (base_m_ + per_metre_ * nearest_m + per_radius_ * radius_m);
  }
  double typical_radius_m() const { return typical_radius_m_; }   ///< on surveyed ground
  std::size_t places() const { return places_.size(); }
  std::string basis() const;
  struct Line {
    double base_m, per_metre, per_radius, median_share;
  };
  Line line() const { return {base_m_, per_metre_, per_radius_, median_share_}; }

 private:
  struct Checked {
    Place place;
    double error_m = 0.0;
    double nearest_m = 0.0;
    double radius_m = 0.0;
  };
  explicit AccuracyModel(std::shared_ptr<const Site> site) : site_(std::move(site)) {}
  Result<void> check_fold(std::size_t fold, const PipelineSpec& pipeline, const std::vector<struct SurveyedTrack>& tracks);
  void fit();
  void smooth(FloorOrdinal floor, AccuracyField& field) const;

  std::shared_ptr<const Site> site_;
  std::vector<Checked> places_;
  // The general figures, about those that `wayfuse-eval expected` finds in a mall.
  double base_m_ = 0.4;
  double per_metre_ = 0.60;
  double per_radius_ = 0.60;
  double median_share_ = 0.70;
  double typical_radius_m_ = 4.0;
};

}  // namespace wayfuse
