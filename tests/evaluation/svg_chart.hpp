#pragma once

#include <string>
#include <vector>

#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// Colours that stay apart for colour-blind eyes (Okabe and Ito 2008), in a fixed order.
std::string_view series_colour(std::size_t index);

/// A named set of values for a distribution chart.
struct ValueSeries {
  std::string name;
  std::vector<double> values;
  std::string colour = {};  ///< empty: by its place in the list
  bool dashed = false;
  bool thick = false;       ///< what the chart is about; without any, the last
};

struct ChartText {
  std::string title;
  std::string x_axis;
  std::string y_axis;
};

/// Share of the values below x, one line a series; the x axis runs from 0 to `x_most`. An SVG document.
std::string distribution_chart(const ChartText& text, const std::vector<ValueSeries>& series, double x_most);

/// A line chart through points with optional vertical error bars. The y axis begins at `y_least` and leaves room for the legend.
struct LineSeries {
  struct Point {
    double x = 0.0;
    double y = 0.0;
    double low = 0.0;  ///< low = high = y: no bar
    double high = 0.0;
  };
  std::string name;
  std::vector<Point> points;
  bool dashed = false;
  std::string colour = {};  ///< empty: by its place in the list
  bool thick = false;       ///< what the chart is about
};
std::string line_chart(const ChartText& text, const std::vector<LineSeries>& series, double y_least = 0.0);

/// A floor plan to draw on, metres, north up.
struct PlanTrack {
  std::string name;  ///< in the legend; empty = not there
  std::string colour;
  std::vector<BuildingPoint> points;
  double width_m = 0.5;
  double opacity = 1.0;
  bool dots = false;   ///< a dot at every point as well
  bool joined = true;  ///< a line through the points; false for fixes that know nothing of each other
  bool dashed = false;
};
struct PlanArea {
  std::vector<BuildingPoint> cells;  ///< lower left corners
  double size_m = 1.0;
  std::string colour;
  std::string name;
  double opacity = 0.35;
};
struct PlanPicture {
  std::string title;
  const Floor* floor = nullptr;  ///< may have no outline: then the tracks make the frame
  std::vector<PlanArea> areas;   ///< below the tracks
  std::vector<PlanTrack> tracks;
  bool zoom_to_tracks = false;
};
std::string plan_picture(const PlanPicture& picture);

}  // namespace wayfuse
