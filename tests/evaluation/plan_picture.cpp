#include <algorithm>
#include <cmath>

#include "tests/evaluation/svg_chart.hpp"
#include "tests/evaluation/svg_text.hpp"

namespace wayfuse {
namespace {

constexpr double kWidestTrack = 3.0;  // pixels

struct Frame {
  BuildingPoint low{1e300, 1e300};
  BuildingPoint high{-1e300, -1e300};
  void take(BuildingPoint p) {
    low = {std::min(low.x_m, p.x_m), std::min(low.y_m, p.y_m)};
    high = {std::max(high.x_m, p.x_m), std::max(high.y_m, p.y_m)};
  }
  bool empty() const { return low.x_m > high.x_m; }
};

Frame frame_of(const PlanPicture& picture) {
  Frame frame;
  const bool outlined = picture.floor && !picture.floor->outline.rings.empty();
  if (outlined && !picture.zoom_to_tracks) {
    for (const Ring& ring : picture.floor->outline.rings)
      std::for_each(ring.begin(), ring.end(), [&](auto p) { frame.take(p); });
  } else {
    for (const PlanTrack& track : picture.tracks)
      std::for_each(track.points.begin(), track.points.end(), [&](auto p) { frame.take(p); });
    for (const PlanArea& area : picture.areas)
      std::for_each(area.cells.begin(), area.cells.end(), [&](auto p) { frame.take(p); });
  }
  if (frame.empty()) frame = {{0, 0}, {10, 10}};
  const double margin_m = picture.zoom_to_tracks ? 12.0 : 4.0;
  frame.low = {frame.low.x_m - margin_m, frame.low.y_m - margin_m};
  frame.high = {frame.high.x_m + margin_m, frame.high.y_m + margin_m};
  return frame;
}

// Metres to pixels.
struct Paper {
  Frame frame;
  double scale = 1.0;
  double top = 40.0;
  double x(double x_m) const { return (x_m - frame.low.x_m) * scale; }
  double y(double y_m) const { return top + (frame.high.y_m - y_m) * scale; }
  std::string at(BuildingPoint p) const { return brief(x(p.x_m)) + "," + brief(y(p.y_m)); }
  std::string path(const Polygon& polygon) const {
    std::string d;
    for (const Ring& ring : polygon.rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) d += (i == 0 ? "M" : "L") + at(ring[i]);
      d += "Z";
    }
    return d;
  }
};

// At the top right: a legend has the bottom.
std::string scale_bar(const Paper& paper, double width) {
  const double length_m = round_step((paper.frame.high.x_m - paper.frame.low.x_m) / 5.0, 1);
  const double right = width - 16.0;
  const double left = right - length_m * paper.scale;
  return svg_line(left, 30, right, 30, "#222", 2.5) + svg_words(0.5 * (left + right), 24, brief(length_m) + " m", "middle", 12);
}

// Entries from left to right, in as many rows as they need.
class Legend {
 public:
  explicit Legend(double width) : width_(width) {}
  void add(const std::string& name, const std::string& colour, double opacity) {
    if (name.empty()) return;
    const double length = 46.0 + 7.4 * static_cast<double>(name.size());
    if (x_ > 12.0 && x_ + length > width_) {
      x_ = 12.0;
      y_ += 20.0;
    }
    marks_ += svg_line(x_, y_ - 4, x_ + 22, y_ - 4, colour, 5, "stroke-opacity=\"" + brief(opacity) + "\"") +
              svg_words(x_ + 28, y_, name, "start", 12);
    x_ += length;
  }
  double height() const { return y_ + 10.0; }
  std::string at(double top) const { return "<g transform=\"translate(0," + brief(top) + ")\">\n" + marks_ + "</g>\n"; }

 private:
  double width_;
  double x_ = 12.0;
  double y_ = 20.0;
  std::string marks_;
};

std::string track_mark(const Paper& paper, const PlanTrack& track) {
  const double width = std::clamp(track.width_m * paper.scale, 1.0, kWidestTrack);
  std::string points, svg;
  for (const BuildingPoint p : track.points) points += paper.at(p) + " ";
  if (track.joined) {
    svg = "<polyline fill=\"none\" stroke=\"" + track.colour + "\" stroke-width=\"" + brief(width) +
          "\" stroke-opacity=\"" + brief(track.opacity) + "\" stroke-linejoin=\"round\"" +
          (track.dashed ? " stroke-dasharray=\"7 5\"" : " stroke-linecap=\"round\"") + " points=\"" + points + "\"/>\n";
  }
  if (track.dots) {
    for (const BuildingPoint p : track.points) {
      svg += "<circle cx=\"" + brief(paper.x(p.x_m)) + "\" cy=\"" + brief(paper.y(p.y_m)) + "\" r=\"" + brief(1.4 * width) +
             "\" fill=\"" + track.colour + "\" fill-opacity=\"" + brief(track.opacity) + "\"/>\n";
    }
  }
  return svg;
}

}  // namespace

std::string plan_picture(const PlanPicture& picture) {
  Paper paper;
  paper.frame = frame_of(picture);
  const double width_m = paper.frame.high.x_m - paper.frame.low.x_m;
  const double height_m = paper.frame.high.y_m - paper.frame.low.y_m;
  paper.scale = std::min(900.0 / width_m, 800.0 / height_m);
  const double width = std::max(480.0, width_m * paper.scale);
  Legend legend(width);
  for (const PlanArea& area : picture.areas) legend.add(area.name, area.colour, std::min(1.0, 2.0 * area.opacity));
  for (const PlanTrack& track : picture.tracks) legend.add(track.name, track.colour, 1.0);
  const double bottom = paper.top + height_m * paper.scale;
  std::string svg = svg_head(width, bottom + legend.height());
  svg += "<clipPath id=\"plan\"><rect x=\"0\" y=\"" + brief(paper.top) + "\" width=\"" + brief(width) + "\" height=\"" +
         brief(height_m * paper.scale) + "\"/></clipPath>\n<g clip-path=\"url(#plan)\">\n";
  if (picture.floor && !picture.floor->outline.rings.empty()) {
    svg += "<path d=\"" + paper.path(picture.floor->outline) +
           "\" fill=\"#e9e6df\" fill-rule=\"evenodd\" stroke=\"#555\" stroke-width=\"1.2\"/>\n";
    for (const Polygon& walkable : picture.floor->walkable) {
      svg += "<path d=\"" + paper.path(walkable) +
             "\" fill=\"#fff\" fill-rule=\"evenodd\" stroke=\"#b8b2a6\" stroke-width=\"0.5\"/>\n";
    }
  }
  for (const PlanArea& area : picture.areas) {
    std::string d;
    const std::string side = brief(area.size_m * paper.scale);
    for (const BuildingPoint c : area.cells) {
      d += "M" + paper.at({c.x_m, c.y_m + area.size_m}) + "h" + side + "v" + side + "h-" + side + "Z";
    }
    svg += "<path d=\"" + d + "\" fill=\"" + area.colour + "\" fill-opacity=\"" + brief(area.opacity) + "\"/>\n";
  }
  for (const PlanTrack& track : picture.tracks) svg += track_mark(paper, track);
  svg += "</g>\n" + svg_words(10, 24, picture.title, "start", 15, "font-weight=\"bold\"");
  return svg + scale_bar(paper, width) + legend.at(bottom) + "</svg>\n";
}

}  // namespace wayfuse
