#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/net/net_world.hpp"
#include "server/sessions/session_shelf.hpp"
#include "server/webhooks/webhook_queue.hpp"
#include "server/zones/zone_presence.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// Everything an operator can set. Keys, defaults, ranges and meanings stand in one table, settings().
struct ServerConfig {
  std::filesystem::path data = "wayfuse-data";
  std::filesystem::path first_key_file;  ///< empty = the first admin key is shown on standard output, once
  unsigned io_threads = 2;
  unsigned workers = 1;
  Duration drain_within = std::chrono::seconds(5);
  std::string log_level = "info";
  NetSettings net;
  SessionSettings sessions;
  SessionShelfSettings shelf;
  ZoneRules zones;
  WebhookSettings webhooks;
  Duration audit_kept = std::chrono::hours(24 * 365);
};

/// One row of the table that file, environment, flags, checks and documentation share.
struct ConfigSetting {
  std::string_view key;      ///< `section.name` as in the file; the flag is `--section.name`
  std::string_view meaning;  ///< with unit and range
  Result<void> (*take)(ServerConfig&, std::string_view key, std::string_view text);
  std::string (*show)(const ServerConfig&);
  bool reloads = false;      ///< takes effect at SIGHUP; any other change waits for a restart
};
std::span<const ConfigSetting> config_settings();
/// `listen.port` -> `WAYFUSE_LISTEN_PORT`.
std::string environment_name(std::string_view key);

/// Sets one key from its text. An unknown key or a value that does not serve is a fault that names it.
Result<void> set(ServerConfig& config, std::string_view key, std::string_view text);

/// What the command line asks for.
struct CommandLine {
  ServerConfig config;
  bool help = false;
  bool version = false;
  bool check_only = false;
  bool check_as_json = false;
  bool print_config = false;
};

/// File (`--config FILE` or WAYFUSE_CONFIG), then environment, then flags; the later wins. `environment` as in main().
Result<CommandLine> read_command_line(std::span<const char* const> arguments, const char* const* environment);

std::string help_text();
/// The configuration as the TOML file that gives it: every key with its meaning, those that stand at their default commented out.
std::string toml_text(const ServerConfig& config);

}  // namespace wayfuse
