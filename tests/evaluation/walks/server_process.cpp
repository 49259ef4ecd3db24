#include "tests/evaluation/walks/server_process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

namespace wayfuse {
namespace {

// One line; empty at the end of the stream.
std::string read_line(int file) {
  std::string line;
  for (char c = 0; ::read(file, &c, 1) == 1 && c != '\n';) line += c;
  return line;
}

[[noreturn]] void become(const std::string& program, const std::filesystem::path& folder, int output) {
  ::dup2(output, STDOUT_FILENO);
  const std::string data = "--server.data=" + folder.string();
  ::execl(program.c_str(), program.c_str(), data.c_str(), "--listen.port=0", "--log.level=warn",
          static_cast<char*>(nullptr));
  ::_exit(127);
}

}  // namespace

Result<ServerProcess> ServerProcess::start(const std::string& program, const std::filesystem::path& folder) {
  if (::access(program.c_str(), X_OK) != 0)
    return Fault{FaultCode::kNotFound, "server", program + " is not a program: build wayfused"};
  int pipe_ends[2];
  if (::pipe2(pipe_ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe to the server");
  ServerProcess process;
  process.output_ = pipe_ends[0];
  process.pid_ = ::fork();
  if (process.pid_ == 0) become(program, folder, pipe_ends[1]);
  ::close(pipe_ends[1]);
  if (process.pid_ < 0) throw std::runtime_error("no process for the server");
  while (process.port_ == 0) {
    const std::string line = read_line(process.output_);
    if (line.empty()) return Fault{FaultCode::kInternal, "server", program + " ended before it was ready"};
    const auto event = nlohmann::json::parse(line, nullptr, false);
    if (!event.is_object()) continue;
    if (event.contains("admin_key")) process.admin_key_ = event["admin_key"].get<std::string>();
    if (event.contains("port")) process.port_ = event["port"].get<unsigned>();
  }
  return process;
}

ServerProcess::ServerProcess(ServerProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      output_(std::exchange(other.output_, -1)),
      admin_key_(std::move(other.admin_key_)),
      port_(other.port_) {}

ServerProcess::~ServerProcess() {
  if (pid_ > 0) {
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
  }
  if (output_ >= 0) ::close(output_);
}

}  // namespace wayfuse
