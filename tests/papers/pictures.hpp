#pragma once

#include <string>

#include "tests/evaluation/svg_chart.hpp"
#include "tests/papers/experiment.hpp"

namespace wayfuse::papers {

/// How a system looks in every picture of a paper. Dashed where it would hide another one's curve.
struct Look {
  std::string system;
  std::size_t colour = 0;
  bool ours = false;               ///< drawn thick
  bool dashed = false;
  bool fixes = false;              ///< dots that know nothing of each other, instead of a line
};

PlanTrack on_plan(const Look& look, const Track& track);
PlanTrack on_plan(const std::vector<BuildingPoint>& truth);
/// Errors by time, every `every`-th of them, or by number.
LineSeries by_time(const Look& look, const Track& track, std::size_t every = 1);
LineSeries by_number(const Look& look, const Track& track, double first = 1.0);
/// Values without error bars, by number from 1 on.
LineSeries line(const Look& look, const std::vector<double>& values, double first = 1.0);
ValueSeries shares(const Look& look, const Track& track);

}  // namespace wayfuse::papers
