#pragma once

#include <string>
#include <vector>

#include "admin/cli/api_client.hpp"

namespace wayfuse::cli {

/// One thing looked at. The server's own `wayfused --check-json` speaks the same words.
struct Diagnosis {
  std::string check;
  std::string severity;   ///< good, warning or error
  std::string what;
  std::string mend;       ///< empty when good
};

struct DoctorSettings {
  std::string config = "/etc/wayfuse/wayfused.toml";
  std::string wayfused = "wayfused";   ///< the program, looked for in PATH
  std::string user = "wayfuse";        ///< as whom it runs: root looks with that user's eyes
};

/// Looks at the machine (through wayfused itself, where it is installed) and at the server through its API, and finds what is
/// misconfigured. Changes nothing.
std::vector<Diagnosis> examine(const Connection& connection, const DoctorSettings& settings);

/// Prints them; 0 = no error among them.
int report(const std::vector<Diagnosis>& diagnoses, bool json);

}  // namespace wayfuse::cli
