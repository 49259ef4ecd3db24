#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wayfuse {

/// Structured log lines on standard error: one JSON object each with time, level, event and fields.
///
/// No personal data: callers never hand it tokens, addresses, session names or positions [SAFETY C19]. Thread: any.
class Log {
 public:
  using Fields = std::vector<std::pair<std::string_view, std::string>>;
  /// `level` as in the configuration.
  explicit Log(const std::string& level);
  ~Log();

  /// From now on. Thread: any.
  void set_level(const std::string& level);
  void info(std::string_view event, const Fields& fields = {});
  void warn(std::string_view event, const Fields& fields = {});
  void error(std::string_view event, const Fields& fields = {});
  void flush();

 private:
  struct Sink;
  std::unique_ptr<Sink> sink_;
};

/// Text as a JSON string, with quotes.
std::string json_text(std::string_view text);

}  // namespace wayfuse
