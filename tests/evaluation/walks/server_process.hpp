#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// A `wayfused` of our own on a free loopback port. Ended with SIGTERM, and waited for, when this goes.
class ServerProcess {
 public:
  /// Starts the program on the folder and waits until it says that it is ready.
  static Result<ServerProcess> start(const std::string& program, const std::filesystem::path& folder);
  ServerProcess(ServerProcess&& other) noexcept;
  ServerProcess& operator=(ServerProcess&&) = delete;
  ~ServerProcess();

  const std::string& admin_key() const { return admin_key_; }
  unsigned port() const { return port_; }

 private:
  ServerProcess() = default;
  pid_t pid_ = -1;
  int output_ = -1;
  std::string admin_key_;
  unsigned port_ = 0;
};

}  // namespace wayfuse
