#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace wayfuse::wire {

/// Well-formed UTF-8 [Unicode table 3-7]: no overlong forms, no surrogates, nothing beyond U+10FFFF.
bool is_utf8(std::string_view text);
/// Holds C0, DEL or C1 control characters. Precondition: UTF-8.
bool has_controls(std::string_view text);
/// At most `bytes` of it, fit to be shown and encoded: what is not UTF-8 or a control character becomes '?'.
std::string clipped(std::string_view text, std::size_t bytes);
/// The same in single quotes, for fault texts.
std::string quoted(std::string_view text);

/// RFC 4648 section 4, with padding.
std::string to_base64(std::string_view bytes);
/// Strict: padding required, no blanks, unused bits zero.
std::optional<std::string> from_base64(std::string_view text);

/// A finite number as JSON and people read it, the shortest that reads back the same.
void append_number(std::string& out, double value);
std::string shown(double value);

}  // namespace wayfuse::wire
