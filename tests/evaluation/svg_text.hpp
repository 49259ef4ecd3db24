#pragma once

#include <string>
#include <string_view>

namespace wayfuse {

/// Text as it may stand in XML.
std::string xml(std::string_view text);
/// A number with at most two decimals, without trailing zeros.
std::string brief(double value);
/// A step of 1, 2 or 5 times a power of ten that cuts `range` into at most `most` parts.
double round_step(double range, int most);

/// The head of a document in user units of pixels, white ground, sans serif.
std::string svg_head(double width, double height);
std::string svg_words(double x, double y, std::string_view text, std::string_view anchor, int size, std::string_view more = "");
std::string svg_line(double x1, double y1, double x2, double y2, std::string_view colour, double width,
                     std::string_view more = "");

}  // namespace wayfuse
