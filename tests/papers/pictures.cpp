#include "tests/papers/pictures.hpp"

namespace wayfuse::papers {
namespace {

std::string colour(const Look& look) { return std::string(series_colour(look.colour)); }

}  // namespace

PlanTrack on_plan(const Look& look, const Track& track) {
  return {look.system, colour(look), track.points, look.ours ? 0.3 : 0.15, look.fixes ? 0.5 : 1.0, look.fixes, !look.fixes, look.dashed};
}

PlanTrack on_plan(const std::vector<BuildingPoint>& truth) { return {"truth", "#000000", truth, 0.15}; }

LineSeries by_time(const Look& look, const Track& track, std::size_t every) {
  LineSeries line{look.system, {}, look.dashed, colour(look), look.ours};
  for (std::size_t i = 0; i < track.errors_m.size(); i += every) {
    line.points.push_back({track.times_s[i], track.errors_m[i], track.errors_m[i], track.errors_m[i]});
  }
  return line;
}

LineSeries by_number(const Look& look, const Track& track, double first) { return line(look, track.errors_m, first); }

LineSeries line(const Look& look, const std::vector<double>& values, double first) {
  LineSeries line{look.system, {}, look.dashed, colour(look), look.ours};
  for (const double value : values) line.points.push_back({first + static_cast<double>(line.points.size()), value, value, value});
  return line;
}

ValueSeries shares(const Look& look, const Track& track) { return {look.system, track.errors_m, colour(look), look.dashed, look.ours}; }

}  // namespace wayfuse::papers
