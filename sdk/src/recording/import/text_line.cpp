#include "sdk/src/recording/import/text_line.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace wayfuse {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

Result<TextFile> TextFile::read(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return Fault{FaultCode::kNotFound, path, "is a folder, a file is expected"};
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) return Fault{FaultCode::kNotFound, path, "cannot be opened"};
  TextFile file;
  file.path_ = path;
  const std::streamoff size = in.tellg();
  if (size < 0) return Fault{FaultCode::kNotFound, path, "cannot be read"};
  file.content_.resize(static_cast<std::size_t>(size));
  in.seekg(0);
  if (!in.read(file.content_.data(), size)) return Fault{FaultCode::kNotFound, path, "cannot be read"};
  if (file.content_.starts_with("\xEF\xBB\xBF")) file.at_ = 3;
  return file;
}

std::optional<std::string_view> TextFile::next_line() {
  if (at_ >= content_.size()) return std::nullopt;
  std::size_t end = content_.find('\n', at_);
  if (end == std::string::npos) end = content_.size();
  std::string_view line(content_.data() + at_, end - at_);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  at_ = end + 1;
  ++line_number_;
  return line;
}

Fault TextFile::fault(const std::string& cause) const {
  return {FaultCode::kMalformed, path_ + ":" + std::to_string(line_number_), cause};
}

void split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  if (separator == ' ') {
    for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
      const std::size_t end = line.find(' ');
      fields.push_back(line.substr(0, end));
      line.remove_prefix(fields.back().size());
    }
    return;
  }
  for (;;) {
    const std::size_t end = line.find(separator);
    fields.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
  }
}

std::string shown(std::string_view field) {
  constexpr std::size_t kMost = 40;
  std::string text(field.substr(0, kMost));
  for (char& c : text) {
    if (c < 0x20 || c > 0x7e) c = '?';
  }
  return field.size() > kMost ? text + ".." : text;
}

std::optional<double> number(std::string_view field) {
  field = trimmed(field);
  if (field.starts_with('+')) field.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> whole_number(std::string_view field) {
  field = trimmed(field);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

bool numbers(std::span<const std::string_view> fields, std::size_t first, std::span<double> values) {
  if (fields.size() < first + values.size()) return false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = number(fields[first + i]);
    if (!value) return false;
    values[i] = *value;
  }
  return true;
}

}  // namespace wayfuse
