#include "tests/integration/server_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace wayfuse {
namespace {

// The value of a field in one line of flat JSON.
std::string field_of(const std::string& line, const std::string& name) {
  const std::string mark = "\"" + name + "\":";
  const auto at = line.find(mark);
  if (at == std::string::npos) return {};
  auto begin = at + mark.size();
  if (line[begin] == '"') ++begin;
  return line.substr(begin, line.find_first_of("\",}", begin) - begin);
}

}  // namespace

ServerProcess::ServerProcess(const std::string& data, const std::vector<std::string>& flags) {
  std::vector<std::string> arguments = {std::string(WAYFUSE_BINARY_DIR) + "/server/wayfused", "--server.data", data};
  arguments.insert(arguments.end(), flags.begin(), flags.end());
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);

  int pipe[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  errors_file_ = data + ".errors";
  process_ = ::fork();
  if (process_ == 0) {
    const int errors = ::open(errors_file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(pipe[1], STDOUT_FILENO);
    ::dup2(errors, STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ::close(pipe[1]);
  out_ = pipe[0];
  read_until_ready();
}

ServerProcess::~ServerProcess() {
  if (!status_) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  ::close(out_);
  ::unlink(errors_file_.c_str());
}

void ServerProcess::read_until_ready() {
  std::string text;
  char buffer[4096];
  for (;;) {
    const ssize_t count = ::read(out_, buffer, sizeof buffer);  // the end of the stream is the end of the process
    if (count <= 0) break;
    text.append(buffer, static_cast<std::size_t>(count));
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (line.find("first_start") != std::string::npos) key_ = field_of(line, "admin_key");
      if (line.find("\"ready\"") != std::string::npos && line.back() == '}') {
        port_ = static_cast<std::uint16_t>(std::stoi(field_of(line, "port")));
        return;
      }
    }
  }
}

void ServerProcess::signal(int number) {
  ::kill(process_, number);
}

void ServerProcess::allow_descriptors(unsigned count) {
  const rlimit limit{count, count};
  ::prlimit(process_, RLIMIT_NOFILE, &limit, nullptr);
}

std::optional<int> ServerProcess::wait(double patience_s) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience_s);
  while (!status_) {
    int raw = 0;
    if (::waitpid(process_, &raw, WNOHANG) == process_) {
      status_ = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
      std::ostringstream text;
      text << std::ifstream(errors_file_).rdbuf();
      errors_ = text.str();
      break;
    }
    if (std::chrono::steady_clock::now() > give_up) break;
    ::poll(nullptr, 0, 10);
  }
  return status_;
}

}  // namespace wayfuse
