#pragma once

#include <charconv>
#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// A whole text file in memory, walked line by line without copies.
///
/// LF and CRLF end a line; a UTF-8 byte order mark and a missing last newline are taken. Thread: confined to its owner.
class TextFile {
 public:
  /// Fault kNotFound names the file.
  static Result<TextFile> read(const std::string& path);

  /// The next line without its end; absent after the last one.
  std::optional<std::string_view> next_line();
  int line_number() const { return line_number_; }  ///< of the line handed out last, from 1
  const std::string& path() const { return path_; }
  /// A kMalformed fault at `file:line`.
  Fault fault(const std::string& cause) const;

 private:
  std::string path_;
  std::string content_;
  std::size_t at_ = 0;
  int line_number_ = 0;
};

/// Cuts a line at every `separator`; a run of spaces counts as one. Replaces what `fields` held.
void split(std::string_view line, char separator, std::vector<std::string_view>& fields);

/// What a field holds, for people: 40 bytes at most, whatever is not printable ASCII as `?`.
std::string shown(std::string_view field);

/// The whole field as a number, spaces around it allowed; NaN and infinities are not numbers here.
std::optional<double> number(std::string_view field);
std::optional<std::int64_t> whole_number(std::string_view field);

/// Fields `first`.. of a line as numbers; false if one is missing or is none.
bool numbers(std::span<const std::string_view> fields, std::size_t first, std::span<double> values);

}  // namespace wayfuse
