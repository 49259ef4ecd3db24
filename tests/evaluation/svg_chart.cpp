#include "tests/evaluation/svg_chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/evaluation/svg_text.hpp"

namespace wayfuse {
namespace {

constexpr double kWidth = 820.0;
constexpr double kHeight = 500.0;
constexpr double kLeft = 70.0;
constexpr double kTop = 46.0;
constexpr double kRight = 800.0;
constexpr double kBottom = 440.0;
constexpr double kThick = 4.5;  // pixels: a thin dashed curve above it leaves both to be seen

// The plane of a chart: data to pixels, with grid, ticks and labels.
class Plane {
 public:
  Plane(double x_low, double x_high, double y_low, double y_high)
      : x_low_(x_low), x_high_(x_high), y_low_(y_low), y_high_(y_high) {}
  double x(double value) const { return kLeft + (value - x_low_) / (x_high_ - x_low_) * (kRight - kLeft); }
  double y(double value) const { return kBottom - (value - y_low_) / (y_high_ - y_low_) * (kBottom - kTop); }

  std::string grid(const ChartText& text, double x_step, double y_step, double y_scale, std::string_view y_unit) const {
    std::string svg = svg_head(kWidth, kHeight) + svg_words(kLeft, 26, text.title, "start", 16, "font-weight=\"bold\"");
    for (double v = std::ceil(x_low_ / x_step) * x_step; v <= x_high_ + 1e-9; v += x_step) {
      svg += svg_line(x(v), kTop, x(v), kBottom, "#e4e4e4", 1) + svg_words(x(v), kBottom + 18, brief(v), "middle", 12);
    }
    for (double v = std::ceil(y_low_ / y_step) * y_step; v <= y_high_ + 1e-9; v += y_step) {
      svg += svg_line(kLeft, y(v), kRight, y(v), "#e4e4e4", 1) +
             svg_words(kLeft - 8, y(v) + 4, brief(v * y_scale) + std::string(y_unit), "end", 12);
    }
    svg += svg_line(kLeft, kBottom, kRight, kBottom, "#444", 1.2) + svg_line(kLeft, kTop, kLeft, kBottom, "#444", 1.2);
    svg += svg_words(0.5 * (kLeft + kRight), kBottom + 42, text.x_axis, "middle", 13);
    svg += svg_words(0, 0, text.y_axis, "middle", 13,
                     "transform=\"translate(18," + brief(0.5 * (kTop + kBottom)) + ") rotate(-90)\"");
    return svg;
  }

 private:
  double x_low_, x_high_, y_low_, y_high_;
};

std::string polyline(const std::string& points, std::string_view colour, bool dashed, double width = 2.0) {
  return "<polyline fill=\"none\" stroke=\"" + std::string(colour) + "\" stroke-width=\"" + brief(width) +
         "\" stroke-linejoin=\"round\"" + (dashed ? " stroke-dasharray=\"6 4\"" : "") + " points=\"" + points + "\"/>\n";
}

struct Entry {
  std::string name;
  std::string colour;
  bool dashed;
};

std::string colour_of(const std::string& own, std::size_t place) { return own.empty() ? std::string(series_colour(place)) : own; }

// A box of names in the lower right corner, or upper right.
std::string legend(const std::vector<Entry>& names, bool at_the_top) {
  std::size_t longest = 0;
  for (const Entry& entry : names) longest = std::max(longest, entry.name.size());
  const double width = 52.0 + 7.4 * static_cast<double>(longest);
  const double height = 12.0 + 19.0 * static_cast<double>(names.size());
  const double left = kRight - width - 8;
  const double top = at_the_top ? kTop + 8 : kBottom - height - 8;
  std::string svg = "<rect x=\"" + brief(left) + "\" y=\"" + brief(top) + "\" width=\"" + brief(width) + "\" height=\"" +
                    brief(height) + "\" fill=\"#fff\" fill-opacity=\"0.9\" stroke=\"#bbb\"/>\n";
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double y = top + 17.0 + 19.0 * static_cast<double>(i);
    svg += svg_line(left + 8, y - 4, left + 34, y - 4, names[i].colour, 3, names[i].dashed ? "stroke-dasharray=\"6 4\"" : "");
    svg += svg_words(left + 42, y, names[i].name, "start", 12);
  }
  return svg;
}

}  // namespace

std::string_view series_colour(std::size_t index) {
  static constexpr std::array<std::string_view, 9> kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00",
                                                               "#56b4e9", "#7f5539", "#000000", "#999933"};
  return kColours[index % kColours.size()];
}

std::string distribution_chart(const ChartText& text, const std::vector<ValueSeries>& series, double x_most) {
  const Plane plane(0.0, x_most, 0.0, 1.0);
  std::string svg = plane.grid(text, round_step(x_most, 10), 0.1, 100.0, " %");
  std::vector<Entry> names;
  const bool told = std::ranges::any_of(series, &ValueSeries::thick);
  for (std::size_t s = 0; s < series.size(); ++s) {
    std::vector<double> values = series[s].values;
    std::sort(values.begin(), values.end());
    std::string points = brief(plane.x(0)) + "," + brief(plane.y(0)) + " ";
    // 240 columns are finer than the eye; they keep the file small.
    for (int column = 1; column <= 240 && !values.empty(); ++column) {
      const double x = x_most * column / 240.0;
      const auto below = std::upper_bound(values.begin(), values.end(), x) - values.begin();
      points += brief(plane.x(x)) + "," + brief(plane.y(static_cast<double>(below) / static_cast<double>(values.size()))) + " ";
    }
    const bool thick = told ? series[s].thick : s + 1 == series.size();
    const Entry entry{series[s].name, colour_of(series[s].colour, s), series[s].dashed};
    svg += polyline(points, entry.colour, entry.dashed, thick ? (told ? kThick : 3.5) : 2.0);
    names.push_back(entry);
  }
  return svg + legend(names, false) + "</svg>\n";
}

std::string line_chart(const ChartText& text, const std::vector<LineSeries>& series, double y_least) {
  double x_low = 1e300, x_high = -1e300, y_high = y_least;
  for (const LineSeries& line : series) {
    for (const auto& p : line.points) {
      x_low = std::min(x_low, p.x);
      x_high = std::max(x_high, p.x);
      y_high = std::max({y_high, p.y, p.high});
    }
  }
  if (x_low > x_high) x_low = 0.0, x_high = 1.0;
  if (x_low == x_high) x_high = x_low + 1.0;
  if (y_high <= y_least) y_high = y_least + 1.0;
  const double above_legend = 0.94 - 0.05 * static_cast<double>(series.size());  // share of the height, a legend's row takes a twentieth
  const double span = (y_high - y_least) / std::max(0.5, above_legend);
  const Plane plane(x_low, x_high, y_least, y_least + span);
  std::string svg = plane.grid(text, round_step(x_high - x_low, 10), round_step(span, 8), 1.0, "");
  std::vector<Entry> names;
  for (std::size_t s = 0; s < series.size(); ++s) {
    const Entry entry{series[s].name, colour_of(series[s].colour, s), series[s].dashed};
    std::string points;
    for (const auto& p : series[s].points) {
      points += brief(plane.x(p.x)) + "," + brief(plane.y(p.y)) + " ";
      if (p.high > p.low)
        svg += svg_line(plane.x(p.x), plane.y(p.low), plane.x(p.x), plane.y(p.high), entry.colour, 1, "opacity=\"0.6\"");
    }
    svg += polyline(points, entry.colour, entry.dashed, series[s].thick ? kThick : 2.0);
    names.push_back(entry);
  }
  return svg + legend(names, true) + "</svg>\n";
}

}  // namespace wayfuse
