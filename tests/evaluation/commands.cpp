#include "tests/evaluation/commands.hpp"

namespace wayfuse {

std::vector<AddCommand> evaluation_commands() { return {add_site_command, add_walks_command}; }

}  // namespace wayfuse
