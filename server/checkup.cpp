#include "server/checkup.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "server/certificate_checkup.hpp"
#include "server/log.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;
using Findings = std::vector<Finding>;

constexpr double kMegabyte = 1e6;
constexpr double kDiskLeast = 100 * kMegabyte;   // below it a survey's next commits may already fail
constexpr double kDiskComfortable = 1000 * kMegabyte;

std::string megabytes(double bytes) {
  return std::to_string(static_cast<long long>(bytes / kMegabyte)) + " MB";
}

Finding good(std::string_view check, std::string what) {
  return {check, Severity::kGood, std::move(what), {}};
}
Finding warning(std::string_view check, std::string what, std::string mend) {
  return {check, Severity::kWarning, std::move(what), std::move(mend)};
}
Finding error(std::string_view check, std::string what, std::string mend) {
  return {check, Severity::kError, std::move(what), std::move(mend)};
}

// The folder itself, or the nearest one above it that exists: where it would be made.
fs::path existing(fs::path folder) {
  std::error_code ignored;
  folder = fs::absolute(folder, ignored);
  while (!fs::exists(folder, ignored) && folder.has_parent_path() && folder != folder.parent_path()) folder = folder.parent_path();
  return folder;
}

void check_data_folder(const ServerConfig& config, Findings& findings) {
  const std::string name = config.data.string();
  const fs::path there = existing(config.data);
  std::error_code ignored;
  if (!fs::is_directory(there, ignored)) {
    findings.push_back(error("data_folder", there.string() + " is not a folder", "name another one in server.data"));
    return;
  }
  if (::access(there.c_str(), W_OK | X_OK) != 0) {
    findings.push_back(error("data_folder", there.string() + ": " + std::strerror(errno) + " for user " + std::to_string(::geteuid()),
                             "run as the service's user, or chown -R it to that user (package: chown -R wayfuse: " + name + ")"));
    return;
  }
  struct stat mode {};
  if (::stat(config.data.c_str(), &mode) == 0 && (mode.st_mode & S_IRWXO) != 0) {
    findings.push_back(warning("data_folder", name + " is open to every user of this machine", "chmod 0750 " + name));
  } else {
    findings.push_back(good("data_folder", name + (there == fs::absolute(config.data, ignored) ? " can be written" : " will be made")));
  }
  if (!fs::is_directory(config.data, ignored)) return;
  for (const auto& entry : fs::directory_iterator(config.data, ignored)) {
    if (entry.path().extension() == ".corrupt")
      findings.push_back(warning("quarantine", entry.path().string() + " was found corrupt and put aside",
                                 "restore that building from a backup, then remove the file"));
  }
}

void check_disk_space(const ServerConfig& config, Findings& findings) {
  struct statvfs disk {};
  const fs::path there = existing(config.data);
  if (::statvfs(there.c_str(), &disk) != 0) return;
  const double free = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
  const std::string what = megabytes(free) + " free under " + config.data.string();
  if ((disk.f_flag & ST_RDONLY) != 0) {
    findings.push_back(error("disk_space", there.string() + " is mounted read-only", "mount it read-write; see dmesg if it was not meant to be"));
  } else if (free < kDiskLeast) {
    findings.push_back(error("disk_space", what, "make room: uploads are refused when the disk is full"));
  } else if (free < kDiskComfortable) {
    findings.push_back(warning("disk_space", what, "make room before the next survey"));
  } else {
    findings.push_back(good("disk_space", what));
  }
}

// True = a server runs on this folder.
bool check_lock(const ServerConfig& config, Findings& findings) {
  const fs::path file = config.data / "server.sqlite.lock";
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    findings.push_back(good("database_lock", "nobody has the databases open"));
    return false;
  }
  const bool held = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  char text[21] = {};
  (void)!::read(descriptor, text, sizeof text - 1);
  ::close(descriptor);
  const std::string holder(text, std::strcspn(text, " "));
  findings.push_back(good("database_lock", held ? "process " + holder + " serves these databases" : "nobody has the databases open"));
  return held;
}

void check_port(const ServerConfig& config, bool running, Findings& findings) {
  const std::string where = config.net.address + " port " + std::to_string(config.net.port);
  sockaddr_storage address{};
  auto* v4 = reinterpret_cast<sockaddr_in*>(&address);
  auto* v6 = reinterpret_cast<sockaddr_in6*>(&address);
  socklen_t length = 0;
  bool loopback = false;
  if (::inet_pton(AF_INET, config.net.address.c_str(), &v4->sin_addr) == 1) {
    address.ss_family = AF_INET, v4->sin_port = htons(config.net.port), length = sizeof *v4;
    loopback = (ntohl(v4->sin_addr.s_addr) >> 24) == 127;
  } else if (::inet_pton(AF_INET6, config.net.address.c_str(), &v6->sin6_addr) == 1) {
    address.ss_family = AF_INET6, v6->sin6_port = htons(config.net.port), length = sizeof *v6;
    loopback = IN6_IS_ADDR_LOOPBACK(&v6->sin6_addr);
  } else {
    findings.push_back(error("port", config.net.address + " is not an IP address", "set listen.address to one, like 0.0.0.0 or ::"));
    return;
  }
  if (config.net.tls_certificate.empty() && !loopback && !config.net.plain_beyond_loopback) {
    findings.push_back(error("port", "plain HTTP beyond loopback on " + config.net.address,
                             "set tls.certificate and tls.key, or listen.plain_beyond_loopback behind a proxy that speaks TLS"));
    return;
  }
  const int descriptor = ::socket(address.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  ::setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const bool bound = ::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), length) == 0;
  const int why = errno;
  ::close(descriptor);
  if (bound || (running && why == EADDRINUSE)) {
    findings.push_back(good("port", where + (bound ? " is free" : " is in use, by the server that runs")));
  } else {
    findings.push_back(error("port", where + ": " + std::strerror(why),
                             why == EACCES ? "use a port from 1024, or CAP_NET_BIND_SERVICE" : "end what listens there (ss -ltnp), or set listen.port"));
  }
}

void check_first_key_file(const ServerConfig& config, bool running, Findings& findings) {
  if (config.first_key_file.empty()) return;
  struct stat mode {};
  if (::stat(config.first_key_file.c_str(), &mode) == 0) {
    const std::string name = config.first_key_file.string();
    if ((mode.st_mode & 077) != 0) {
      findings.push_back(warning("first_key_file", name + " can be read by other users", "chmod 0600 " + name));
    } else if (running) {
      findings.push_back(warning("first_key_file", name + " still holds the first admin key", "note the key elsewhere, then remove the file"));
    }
    return;
  }
  const fs::path parent = existing(config.first_key_file.parent_path().empty() ? fs::path(".") : config.first_key_file.parent_path());
  if (!running && ::access(parent.c_str(), W_OK | X_OK) != 0)
    findings.push_back(error("first_key_file", parent.string() + ": " + std::strerror(errno), "let server.first_key_file name a place that can be written"));
}

double number_in(const char* file) {
  double number = 0;
  std::ifstream(file) >> number;
  return number;
}

void check_limits(const ServerConfig& config, Findings& findings) {
  double memory = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  for (const char* file : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    if (const double limit = number_in(file); limit > 0) memory = std::min(memory, limit);
  }
  const auto wanted = static_cast<double>(config.net.memory_budget_bytes);
  if (wanted > 0.9 * memory) {
    findings.push_back(warning("memory", "limits.memory_bytes is " + megabytes(wanted) + ", this machine or container has " + megabytes(memory),
                               "set limits.memory_bytes to 80 % of what there is: sessions are refused before the kernel kills the server"));
  } else {
    findings.push_back(good("memory", "limits.memory_bytes " + megabytes(wanted) + " of " + megabytes(memory)));
  }
  rlimit descriptors{};
  ::getrlimit(RLIMIT_NOFILE, &descriptors);
  const std::uint64_t needed = config.net.connections_most + 200;  // databases, logs, listeners
  if (descriptors.rlim_max < needed) {
    findings.push_back(warning("descriptors", "at most " + std::to_string(descriptors.rlim_max) + " open files, limits.connections needs " + std::to_string(needed),
                               "raise LimitNOFILE (ulimit -Hn), or lower limits.connections"));
  } else {
    findings.push_back(good("descriptors", std::to_string(descriptors.rlim_max) + " open files are allowed"));
  }
}

void check_clock(Findings& findings) {
  timex state{};
  if (::adjtimex(&state) == TIME_ERROR || (state.status & STA_UNSYNC) != 0) {
    findings.push_back(warning("clock", "the kernel does not count the clock as synchronised", "run chrony or systemd-timesyncd: key expiry and certificates go by it"));
  } else {
    findings.push_back(good("clock", "synchronised"));
  }
}

constexpr std::string_view word(Severity severity) {
  return severity == Severity::kGood ? "good" : severity == Severity::kWarning ? "warning" : "error";
}

}  // namespace

std::vector<Finding> check_up(const ServerConfig& config) {
  Findings findings;
  check_data_folder(config, findings);
  check_disk_space(config, findings);
  const bool running = check_lock(config, findings);
  check_port(config, running, findings);
  check_certificate(config.net, findings);
  check_first_key_file(config, running, findings);
  check_limits(config, findings);
  check_clock(findings);
  return findings;
}

bool serves(const std::vector<Finding>& findings) {
  return std::ranges::none_of(findings, [](const Finding& finding) { return finding.severity == Severity::kError; });
}

std::string to_text(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings) {
    text += std::string(word(finding.severity)) + "  " + std::string(finding.check) + ": " + finding.what + "\n";
    if (!finding.mend.empty()) text += "         mend: " + finding.mend + "\n";
  }
  return text + (serves(findings) ? "the configuration serves\n" : "the configuration does not serve\n");
}

std::string to_json(const std::vector<Finding>& findings) {
  std::string json;
  for (const Finding& finding : findings) {
    json += (json.empty() ? "" : ",") + std::string("{\"check\":") + json_text(finding.check) + ",\"severity\":" + json_text(word(finding.severity)) +
            ",\"what\":" + json_text(finding.what) + ",\"mend\":" + json_text(finding.mend) + "}";
  }
  return "{\"findings\":[" + json + "]}\n";
}

}  // namespace wayfuse
