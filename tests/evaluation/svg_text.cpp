#include "tests/evaluation/svg_text.hpp"

#include <cmath>
#include <cstdio>

namespace wayfuse {

std::string xml(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string brief(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  std::string shown = text;
  while (shown.back() == '0') shown.pop_back();
  if (shown.back() == '.') shown.pop_back();
  return shown == "-0" ? "0" : shown;
}

double round_step(double range, int most) {
  if (!(range > 0.0)) return 1.0;
  const double raw = range / most;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

std::string svg_head(double width, double height) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + brief(width) + " " + brief(height) + "\" width=\"" +
         brief(width) + "\" height=\"" + brief(height) +
         "\" font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\">\n<rect width=\"100%\" height=\"100%\" "
         "fill=\"#fff\"/>\n";
}

std::string svg_words(double x, double y, std::string_view text, std::string_view anchor, int size, std::string_view more) {
  return "<text x=\"" + brief(x) + "\" y=\"" + brief(y) + "\" text-anchor=\"" + std::string(anchor) + "\" font-size=\"" +
         std::to_string(size) + "\" fill=\"#222\" " + std::string(more) + ">" + xml(text) + "</text>\n";
}

std::string svg_line(double x1, double y1, double x2, double y2, std::string_view colour, double width, std::string_view more) {
  return "<line x1=\"" + brief(x1) + "\" y1=\"" + brief(y1) + "\" x2=\"" + brief(x2) + "\" y2=\"" + brief(y2) + "\" stroke=\"" +
         std::string(colour) + "\" stroke-width=\"" + brief(width) + "\" " + std::string(more) + "/>\n";
}

}  // namespace wayfuse
