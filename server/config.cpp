#include "server/config.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <sstream>

namespace wayfuse {
namespace {

using Text = std::string_view;

template <typename Number>
Result<Number> number_in(Text key, Text text, Number least, Number most) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= least && value <= most)) {
    std::ostringstream cause;
    cause << text << " is not a number in " << least << ".." << most;
    return Fault{FaultCode::kOutOfRange, std::string(key), cause.str()};
  }
  return value;
}

template <typename Target, typename Number>
Result<void> take_number(Target& target, Text key, Text text, Number least, Number most) {
  const auto value = number_in<Number>(key, text, least, most);
  if (!value) return value.fault();
  target = static_cast<Target>(*value);
  return {};
}

Result<void> take_seconds(Duration& target, Text key, Text text, double least, double most) {
  const auto value = number_in<double>(key, text, least, most);
  if (!value) return value.fault();
  target = from_seconds(*value);
  return {};
}

Result<void> take_switch(bool& target, Text key, Text text) {
  if (text != "true" && text != "false")
    return Fault{FaultCode::kOutOfRange, std::string(key), std::string(text) + " is not true or false"};
  target = text == "true";
  return {};
}

std::string show_number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}
std::string in_quotes(Text text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += letter;
  }
  return quoted + '"';
}

Result<void> take_level(ServerConfig& config, Text key, Text text) {
  constexpr std::array<Text, 5> levels = {"debug", "info", "warn", "error", "off"};
  if (std::ranges::find(levels, text) == levels.end()) {
    return Fault{FaultCode::kUnknownName, std::string(key), std::string(text) + " is not one of debug, info, warn, error, off"};
  }
  config.log_level = text;
  return {};
}

using Config = ServerConfig;
#define WAYFUSE_TEXT(field)                        \
  [](Config& c, Text, Text text) -> Result<void> { \
    c.field = std::string(text);                   \
    return {};                                     \
  },                                               \
      [](const Config& c) { return in_quotes(std::string(c.field)); }
#define WAYFUSE_COUNT(field, least, most)                                                  \
  [](Config& c, Text key, Text text) {                                                     \
    return take_number<decltype(c.field), std::uint64_t>(c.field, key, text, least, most); \
  },                                                                                       \
      [](const Config& c) { return std::to_string(c.field); }
#define WAYFUSE_SECONDS(field, least, most)                                                     \
  [](Config& c, Text key, Text text) { return take_seconds(c.field, key, text, least, most); }, \
      [](const Config& c) { return show_number(seconds(c.field)); }
#define WAYFUSE_RATE(field, least, most)                                                                       \
  [](Config& c, Text key, Text text) { return take_number<double, double>(c.field, key, text, least, most); }, \
      [](const Config& c) { return show_number(c.field); }

const std::array kSettings = {
    ConfigSetting{"server.data", "folder of the databases; made when missing", WAYFUSE_TEXT(data)},
    ConfigSetting{"server.first_key_file", "where the first admin key is written (mode 0600) instead of being shown",
                  WAYFUSE_TEXT(first_key_file)},
    ConfigSetting{"server.io_threads", "threads that serve connections, 1..64", WAYFUSE_COUNT(io_threads, 1, 64)},
    ConfigSetting{"server.workers", "threads that build radio maps, 1..64", WAYFUSE_COUNT(workers, 1, 64)},
    ConfigSetting{"server.drain_s", "over how long clients are sent away at SIGTERM, 0..8 s",
                  WAYFUSE_SECONDS(drain_within, 0, 8)},
    ConfigSetting{"listen.address", "IP address; beyond loopback only with TLS or listen.plain_beyond_loopback",
                  WAYFUSE_TEXT(net.address)},
    ConfigSetting{"listen.port", "TCP port; 0 = any free one, told in the ready line", WAYFUSE_COUNT(net.port, 0, 65535)},
    ConfigSetting{"listen.plain_beyond_loopback", "plain HTTP on any address: only behind a proxy that speaks TLS",
                  [](Config& c, Text key, Text text) { return take_switch(c.net.plain_beyond_loopback, key, text); },
                  [](const Config& c) { return std::string(c.net.plain_beyond_loopback ? "true" : "false"); }},
    ConfigSetting{"tls.certificate", "PEM file with the chain; empty = no TLS; its content is read again at SIGHUP",
                  WAYFUSE_TEXT(net.tls_certificate)},
    ConfigSetting{"tls.key", "PEM file with the private key; its content is read again at SIGHUP", WAYFUSE_TEXT(net.tls_key)},
    ConfigSetting{"limits.connections", "open at a time, 1..1000000", WAYFUSE_COUNT(net.connections_most, 1, 1'000'000)},
    ConfigSetting{"limits.half_open", "connections without a complete request, 1..1000000",
                  WAYFUSE_COUNT(net.half_open_most, 1, 1'000'000)},
    ConfigSetting{"limits.handshake_s", "for TLS and the first request's header, 0.1..600 s",
                  WAYFUSE_SECONDS(net.handshake_deadline, 0.1, 600)},
    ConfigSetting{"limits.connections_per_address", "open at a time from one address, 1..1000000",
                  WAYFUSE_COUNT(net.addresses.connections_most, 1, 1'000'000)},
    ConfigSetting{"limits.arrivals_per_address", "new connections a second from one address in the long run, 0.1..1e6",
                  WAYFUSE_RATE(net.addresses.connections_per_second, 0.1, 1e6)},
    ConfigSetting{"limits.arrivals_burst", "and at once, 1..1e6", WAYFUSE_RATE(net.addresses.connections_burst, 1, 1e6)},
    ConfigSetting{"limits.refusals_per_address", "wrong keys a second from one address in the long run, 0.01..1e6",
                  WAYFUSE_RATE(net.addresses.refusals_per_second, 0.01, 1e6)},
    ConfigSetting{"limits.refusals_burst", "and at once, 1..1e6", WAYFUSE_RATE(net.addresses.refusals_burst, 1, 1e6)},
    ConfigSetting{"limits.frames_per_second", "of one session in the long run; beyond it reading pauses, 1..1e6",
                  WAYFUSE_RATE(net.frames_per_second, 1, 1e6)},
    ConfigSetting{"limits.frames_burst", "and at once, 1..1e6", WAYFUSE_RATE(net.frames_burst, 1, 1e6)},
    ConfigSetting{"limits.memory_bytes", "of connections and sessions: new ones are refused at 80 %, observers closed at 95 %",
                  WAYFUSE_COUNT(net.memory_budget_bytes, 1u << 20, std::uint64_t{1} << 46)},
    ConfigSetting{"sessions.most", "tracking sessions, connected or resumable, 1..1000000",
                  WAYFUSE_COUNT(shelf.most, 1, 1'000'000)},
    ConfigSetting{"sessions.resumable_s", "how long a session outlives its connection, 0..86400 s",
                  WAYFUSE_SECONDS(shelf.resumable, 0, 86400)},
    ConfigSetting{"sessions.hello_s", "from the open connection to its hello, 0.1..600 s",
                  WAYFUSE_SECONDS(sessions.hello_deadline, 0.1, 600)},
    ConfigSetting{"sessions.idle_s", "without a valid message before the connection is closed, 1..86400 s",
                  WAYFUSE_SECONDS(sessions.idle_deadline, 1, 86400)},
    ConfigSetting{"zones.enter", "probability inside from which a phone enters a zone, 0.5..1", WAYFUSE_RATE(zones.enter, 0.5, 1)},
    ConfigSetting{"zones.leave", "probability inside up to which it leaves, 0..0.5", WAYFUSE_RATE(zones.leave, 0, 0.5)},
    ConfigSetting{"zones.settle_m", "walked under such evidence before it is believed, 0..50 m", WAYFUSE_RATE(zones.settle_m, 0, 50)},
    ConfigSetting{"zones.settle_at_rest_s", "or stood, 0..3600 s", WAYFUSE_SECONDS(zones.settle_at_rest, 0, 3600)},
    ConfigSetting{"zones.corrected_within_s", "a transition this young is taken back when the position jumps, 0..3600 s",
                  WAYFUSE_SECONDS(zones.corrected_within, 0, 3600)},
    ConfigSetting{"webhooks.private_targets", "webhooks may lead to loopback and private networks, and over plain HTTP",
                  [](Config& c, Text key, Text text) { return take_switch(c.webhooks.private_targets, key, text); },
                  [](const Config& c) { return std::string(c.webhooks.private_targets ? "true" : "false"); }},
    ConfigSetting{"webhooks.attempts", "before an event is a dead letter, 1..100", WAYFUSE_COUNT(webhooks.attempts, 1, 100)},
    ConfigSetting{"webhooks.first_wait_s", "before the second attempt; doubled at each further one, 0.01..3600 s",
                  WAYFUSE_SECONDS(webhooks.first_wait, 0.01, 3600)},
    ConfigSetting{"webhooks.longest_wait_s", "between two attempts, 0.01..86400 s", WAYFUSE_SECONDS(webhooks.longest_wait, 0.01, 86400)},
    ConfigSetting{"privacy.audit_s", "how long the audit is kept, 3600..3.2e8 s", WAYFUSE_SECONDS(audit_kept, 3600, 3.2e8)},
    ConfigSetting{"log.level", "debug, info, warn, error or off; read again at SIGHUP", take_level,
                  [](const Config& c) { return in_quotes(c.log_level); }, true},
};
#undef WAYFUSE_TEXT
#undef WAYFUSE_COUNT
#undef WAYFUSE_SECONDS
#undef WAYFUSE_RATE

Fault unknown(Text key) {
  Text nearest;
  std::size_t most = 0;
  for (const ConfigSetting& setting : kSettings) {
    const auto [a, b] = std::ranges::mismatch(setting.key, key);
    const auto same = static_cast<std::size_t>(a - setting.key.begin());
    if (same > most) most = same, nearest = setting.key;
  }
  std::string cause = "there is no such key";
  if (!nearest.empty()) cause += "; did you mean " + std::string(nearest) + "?";
  return {FaultCode::kUnknownName, std::string(key), cause};
}

std::string text_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  return out.str();
}

Result<void> read_table(ServerConfig& config, const toml::table& table, const std::string& prefix) {
  for (const auto& [name, node] : table) {
    const std::string key = prefix + std::string(name.str());
    const auto taken = node.is_table() ? read_table(config, *node.as_table(), key + ".") : set(config, key, text_of(node));
    if (!taken) return taken.fault();
  }
  return {};
}

Result<void> read_file(ServerConfig& config, const std::string& file) {
  try {
    return read_table(config, toml::parse_file(file), "");
  } catch (const toml::parse_error& error) {
    std::ostringstream cause;
    cause << error.description() << " at " << error.source().begin;
    return Fault{FaultCode::kMalformed, file, cause.str()};
  }
}

Result<void> read_environment(ServerConfig& config, const char* const* environment) {
  constexpr Text kPrefix = "WAYFUSE_";
  for (; environment && *environment; ++environment) {
    const Text entry = *environment;
    const Text name = entry.substr(0, entry.find('='));
    if (!name.starts_with(kPrefix) || name == "WAYFUSE_CONFIG" || name.size() == entry.size()) continue;
    const auto row =
        std::ranges::find(kSettings, name, [](const ConfigSetting& setting) { return environment_name(setting.key); });
    // Other wayfuse programs have variables of their own; only names of our sections can be misspelt.
    if (row == kSettings.end()) {
      const bool ours = std::ranges::any_of(std::array<Text, 8>{"SERVER_", "LISTEN_", "TLS_", "LIMITS_", "SESSIONS_", "ZONES_", "WEBHOOKS_", "PRIVACY_"},
                                            [&](Text section) { return name.substr(kPrefix.size()).starts_with(section); });
      if (ours) return unknown(name);
      continue;
    }
    if (const auto taken = row->take(config, name, entry.substr(name.size() + 1)); !taken) return taken.fault();
  }
  return {};
}

std::optional<std::string> in_environment(const char* const* environment, Text wanted) {
  for (; environment && *environment; ++environment) {
    const Text entry = *environment;
    if (entry.starts_with(wanted) && entry.size() > wanted.size() && entry[wanted.size()] == '=')
      return std::string(entry.substr(wanted.size() + 1));
  }
  return std::nullopt;
}

}  // namespace

std::span<const ConfigSetting> config_settings() {
  return kSettings;
}

std::string environment_name(std::string_view key) {
  std::string name = "WAYFUSE_";
  for (const char letter : key)
    name += letter == '.' ? '_' : static_cast<char>(letter >= 'a' && letter <= 'z' ? letter - ('a' - 'A') : letter);
  return name;
}

Result<void> set(ServerConfig& config, std::string_view key, std::string_view text) {
  const auto row = std::ranges::find(kSettings, key, &ConfigSetting::key);
  if (row == kSettings.end()) return unknown(key);
  return row->take(config, key, text);
}

Result<CommandLine> read_command_line(std::span<const char* const> arguments, const char* const* environment) {
  CommandLine line;
  std::vector<std::pair<std::string, std::string>> flags;
  std::optional<std::string> file = in_environment(environment, "WAYFUSE_CONFIG");
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const Text argument = arguments[i];
    if (argument == "--help" || argument == "-h") {
      line.help = true;
    } else if (argument == "--version") {
      line.version = true;
    } else if (argument == "--check" || argument == "--check-json") {
      line.check_only = true;
      line.check_as_json = argument == "--check-json";
    } else if (argument == "--print-config") {
      line.print_config = true;
    } else if (argument.starts_with("--")) {
      const std::size_t equals = argument.find('=');
      const std::string key(argument.substr(2, equals == Text::npos ? Text::npos : equals - 2));
      if (equals == Text::npos && i + 1 >= arguments.size())
        return Fault{FaultCode::kMissingField, key, "the flag needs a value"};
      const std::string value(equals == Text::npos ? Text(arguments[++i]) : argument.substr(equals + 1));
      if (key == "config") {
        file = value;
      } else {
        flags.emplace_back(key, value);
      }
    } else {
      return unknown(argument);
    }
  }
  if (file) {
    if (const auto read = read_file(line.config, *file); !read) return read.fault();
  }
  if (const auto read = read_environment(line.config, environment); !read) return read.fault();
  for (const auto& [key, value] : flags) {
    if (const auto taken = set(line.config, key, value); !taken) return taken.fault();
  }
  return line;
}

std::string help_text() {
  std::ostringstream help;
  help << "wayfused: the wayfuse positioning server\n\n"
          "  wayfused [--config FILE] [--KEY VALUE]...   serve until SIGTERM\n"
          "  wayfused --check | --check-json [...]       look whether it could serve with this configuration, and leave\n"
          "  wayfused --print-config [...]               print it as a TOML file with every key, and leave\n"
          "  wayfused --help | --version\n\n"
          "Keys are the same in the TOML file ([section] name = value), as flags (--section.name value) and in the\n"
          "environment (WAYFUSE_SECTION_NAME). Flags win over the environment, the environment over the file.\n\n";
  const ServerConfig standard;
  for (const ConfigSetting& setting : kSettings) {
    help << "  " << setting.key << " = " << setting.show(standard) << "\n      " << setting.meaning << "\n";
  }
  return help.str();
}

std::string toml_text(const ServerConfig& config) {
  std::ostringstream text;
  text << "# Configuration of wayfused. What is commented out stands at its default.\n"
          "# Flags and WAYFUSE_SECTION_NAME in the environment win over this file. `wayfused --check --config THIS` looks it over.\n";
  const ServerConfig standard;
  Text section;
  for (const ConfigSetting& setting : kSettings) {
    const auto dot = setting.key.find('.');
    if (setting.key.substr(0, dot) != section) {
      section = setting.key.substr(0, dot);
      text << "\n[" << section << "]\n";
    }
    const std::string value = setting.show(config);
    text << "# " << setting.meaning << '\n' << (value == setting.show(standard) ? "# " : "") << setting.key.substr(dot + 1) << " = " << value << '\n';
  }
  return text.str();
}

}  // namespace wayfuse
