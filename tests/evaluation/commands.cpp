#include "tests/evaluation/commands.hpp"

namespace wayfuse {

std::vector<AddCommand> evaluation_commands() {
  return {add_walks_command, add_fingerprints_command, add_papers_command, add_attitude_command, add_walking_command, add_climbing_command, add_site_command,
          add_expected_command, add_access_points_command, add_devices_command};
}

}  // namespace wayfuse
