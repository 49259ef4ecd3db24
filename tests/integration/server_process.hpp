#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace wayfuse {

/// A wayfused of its own: started, killed, waited for. Its standard output is read line by line.
class ServerProcess {
 public:
  /// Starts on any port over `data`, with more flags; returns once the ready line came or the process ended.
  ServerProcess(const std::string& data, const std::vector<std::string>& flags = {});
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  bool ready() const { return port_ != 0; }
  std::uint16_t port() const { return port_; }
  /// The admin key of the first start.
  const std::string& key() const { return key_; }
  const std::string& errors() const { return errors_; }

  void signal(int number);
  /// No more file descriptors than this from now on.
  void allow_descriptors(unsigned count);
  /// The exit status, or 128 + the signal that ended it; absent if it still runs after `patience_s`.
  std::optional<int> wait(double patience_s);

 private:
  void read_until_ready();

  pid_t process_ = -1;
  int out_ = -1;
  std::string errors_file_;
  std::string errors_;
  std::uint16_t port_ = 0;
  std::string key_;
  std::optional<int> status_;
};

}  // namespace wayfuse
