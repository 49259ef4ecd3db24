#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "admin/cli/api_client.hpp"

/// What the command line's commands share. A group of commands is a file `*_commands.cpp` and a line here.
namespace wayfuse::cli {

/// One request to the admin API, and how its answer is shown.
struct Call {
  std::string method;
  std::string path;
  std::string body = {};
  std::string list = {};                  ///< the answer's list shown as a table
  std::vector<std::string> fields = {};   ///< its columns
  bool raw = false;                       ///< print as it comes: exports
  std::string content_type = "application/json";
  std::map<std::string, std::string> headers = {};
  std::string (*show)(const std::string& json) = nullptr;   ///< instead of a table
};

struct Program {
  Connection connection;
  bool json = false;
  std::string building = "1";
  std::string id, file, name, format = "csv";
  std::vector<std::string> scopes;
  double expires_in_s = 0;
  bool coarse = false;
  Call call;
  /// Instead of `call`, for what takes more than one request; answers the exit status.
  std::function<int()> run;
};

/// A whole file, `-` = standard input. Throws std::runtime_error.
std::string content_of(const std::string& file);
/// Writes a file, `-` = standard output. Throws std::runtime_error.
void write_content(const std::string& file, const std::string& content);
/// The server's own words on standard error: title, field and cause of its problem document. Answers EXIT_FAILURE.
int refused(const Reply& reply);
/// Sends the call and shows the answer; the exit status.
int perform(const Program& program, const Call& call);
/// `/v1/buildings/BUILDING` and what follows.
std::string building_path(const Program& program, const std::string& what);
/// Percent-encoded for a query or a path segment.
std::string escaped(const std::string& text);

void add_building_commands(CLI::App& app, Program& program);
void add_survey_commands(CLI::App& app, Program& program);
/// After the survey's commands: it adds to them.
void add_map_commands(CLI::App& app, Program& program);
void add_key_commands(CLI::App& app, Program& program);
void add_operation_commands(CLI::App& app, Program& program);
/// Some of these add to `building` and `survey`, which must be there.
void add_zone_commands(CLI::App& app, Program& program);
void add_plan_commands(CLI::App& app, Program& program);
void add_data_commands(CLI::App& app, Program& program);
void add_recording_commands(CLI::App& app, Program& program);
void add_webhook_commands(CLI::App& app, Program& program);

}  // namespace wayfuse::cli
