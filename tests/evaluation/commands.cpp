#include "tests/evaluation/commands.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>

namespace wayfuse {

std::vector<AddCommand> evaluation_commands() {
  return {add_walks_command, add_fingerprints_command, add_papers_command, add_attitude_command, add_walking_command, add_climbing_command, add_site_command,
          add_expected_command, add_access_points_command, add_devices_command, add_agreement_command};
}

void add_site_options(CLI::App& command, std::string& data, std::vector<std::string>& floors) {
  command.add_option("--data", data, "Folder of one site: <floor>/path_data_files/*.txt")->required();
  command.add_option("--floors", floors, "Only these floors, by label (comma separated)")->delimiter(',');
}

Result<void> check_targets(const std::string& json, const std::string& report) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (!json.empty()) {
    const bool there = fs::exists(json, ignored);
    if (!std::ofstream(json, std::ios::app)) return Fault{FaultCode::kNotFound, json, "cannot be written"};
    if (!there) fs::remove(json, ignored);
  }
  if (!report.empty()) {
    fs::create_directories(report, ignored);
    if (!fs::is_directory(report, ignored) || ::access(report.c_str(), W_OK | X_OK) != 0)
      return Fault{FaultCode::kNotFound, report, "is no folder that can be written to"};
  }
  return {};
}

CLI::Option* add_split_option(CLI::App& command, std::string& split) {
  return command.add_option("--split", split, "test, or dev: the development part of the survey walks")
      ->check(CLI::IsMember({"test", "dev"}))
      ->capture_default_str();
}

}  // namespace wayfuse
