#pragma once

#include <functional>
#include <string>
#include <vector>

#include "wayfuse/proto/result.hpp"

namespace CLI {
class App;
class Option;
}

namespace wayfuse {

/// Adds one subcommand; when it is parsed it sets `chosen` to its work, whose value is the exit status.
using AddCommand = void (*)(CLI::App& app, std::function<int()>& chosen);

/// One file a subcommand; a new one is a file, a line here and a row in commands.cpp.
void add_papers_command(CLI::App& app, std::function<int()>& chosen);
void add_fingerprints_command(CLI::App& app, std::function<int()>& chosen);
void add_site_command(CLI::App& app, std::function<int()>& chosen);
void add_walks_command(CLI::App& app, std::function<int()>& chosen);
void add_attitude_command(CLI::App& app, std::function<int()>& chosen);
void add_climbing_command(CLI::App& app, std::function<int()>& chosen);
void add_walking_command(CLI::App& app, std::function<int()>& chosen);
void add_expected_command(CLI::App& app, std::function<int()>& chosen);
void add_access_points_command(CLI::App& app, std::function<int()>& chosen);
void add_agreement_command(CLI::App& app, std::function<int()>& chosen);
void add_devices_command(CLI::App& app, std::function<int()>& chosen);

std::vector<AddCommand> evaluation_commands();

/// What commands over a site of recorded walks are told alike.
void add_site_options(CLI::App& command, std::string& data, std::vector<std::string>& floors);
CLI::Option* add_split_option(CLI::App& command, std::string& split);

/// That what a run is to write can be written, before it takes its time; makes the report's folder. Empty = not asked for.
Result<void> check_targets(const std::string& json, const std::string& report);

}  // namespace wayfuse
