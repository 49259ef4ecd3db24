#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/config.hpp"

namespace wayfuse {

enum class Severity { kGood, kWarning, kError };

/// What one look at the configuration and the machine under it found.
struct Finding {
  std::string_view check;      ///< its name, stable: `tls`, `disk_space`, ..
  Severity severity = Severity::kGood;
  std::string what;
  std::string mend;            ///< what to do about it; empty when good
};

/// Looks at everything that keeps a server from serving with `config`, without starting one and without changing anything: data folder,
/// disk space, database lock, certificate and key, port, first key's file, memory and descriptor limits, clock.
/// A server that runs on the same data folder is no fault.
std::vector<Finding> check_up(const ServerConfig& config);

/// No error among them.
bool serves(const std::vector<Finding>& findings);
/// One line a finding; one JSON object `{"findings":[{"check":..,"severity":"good|warning|error","what":..,"mend":..}]}`.
std::string to_text(const std::vector<Finding>& findings);
std::string to_json(const std::vector<Finding>& findings);

}  // namespace wayfuse
