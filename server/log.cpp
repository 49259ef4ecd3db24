#include "server/log.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

namespace wayfuse {

struct Log::Sink {
  spdlog::logger logger{"wayfuse", std::make_shared<spdlog::sinks::stderr_sink_mt>()};

  void write(spdlog::level::level_enum level, std::string_view event, const Fields& fields) {
    if (!logger.should_log(level)) return;
    std::string line = "\"event\":" + json_text(event);
    for (const auto& [name, value] : fields) line += "," + json_text(name) + ":" + json_text(value);
    logger.log(level, "{}", line);
  }
};

Log::Log(const std::string& level) : sink_(std::make_unique<Sink>()) {
  sink_->logger.set_pattern(R"({"time":"%Y-%m-%dT%H:%M:%S.%fZ","level":"%l",%v})", spdlog::pattern_time_type::utc);
  sink_->logger.set_level(spdlog::level::from_str(level));
  sink_->logger.flush_on(spdlog::level::info);
}
Log::~Log() = default;

void Log::set_level(const std::string& level) {
  sink_->logger.set_level(spdlog::level::from_str(level));
}

void Log::info(std::string_view event, const Fields& fields) {
  sink_->write(spdlog::level::info, event, fields);
}
void Log::warn(std::string_view event, const Fields& fields) {
  sink_->write(spdlog::level::warn, event, fields);
}
void Log::error(std::string_view event, const Fields& fields) {
  sink_->write(spdlog::level::err, event, fields);
}
void Log::flush() {
  sink_->logger.flush();
}

std::string json_text(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace wayfuse
