#include "admin/cli/doctor.hpp"

#include <pwd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

namespace wayfuse::cli {
namespace {

using Json = nlohmann::json;
using Diagnoses = std::vector<Diagnosis>;

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char letter : word) text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return text + "'";
}

struct Ran {
  int status = 127;
  std::string output;
};

Ran run(const std::string& command) {
  std::fflush(stdout);
  Ran ran;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "re");
  if (!pipe) return ran;
  char part[4096];
  for (std::size_t count; (count = std::fread(part, 1, sizeof part, pipe)) > 0;) ran.output.append(part, count);
  const int raw = ::pclose(pipe);
  ran.status = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128;
  return ran;
}

// Root may write everywhere; the service may not.
std::string with_the_service_eyes(const std::string& user, const std::string& command) {
  if (::geteuid() != 0 || user.empty() || !::getpwnam(user.c_str())) return command;
  return "runuser -u " + quoted(user) + " -- " + command;
}

void examine_machine(const DoctorSettings& settings, Diagnoses& found) {
  std::string command = quoted(settings.wayfused) + " --check-json";
  std::error_code ignored;
  if (std::filesystem::exists(settings.config, ignored)) {
    command += " --config " + quoted(settings.config);
  } else {
    found.push_back({"configuration", "warning", settings.config + " is not there; defaults and environment are looked at",
                     "name the server's file with --config, if it has one"});
  }
  const Ran ran = run(with_the_service_eyes(settings.user, command));
  if (ran.status == 127) {
    found.push_back({"machine", "warning", settings.wayfused + " is not installed here: only the server's answers are looked at",
                     "run this on the server's machine, or name the program with --wayfused"});
    return;
  }
  const Json parsed = Json::parse(ran.output, nullptr, false);
  if (!parsed.is_object() || !parsed.contains("findings")) {
    const std::string said = ran.output.substr(0, ran.output.find('\n'));
    found.push_back({"configuration", "error", said, "correct that key in " + settings.config + "; wayfused --print-config shows every key"});
    return;
  }
  for (const Json& one : parsed["findings"]) {
    found.push_back({one.value("check", ""), one.value("severity", ""), one.value("what", ""), one.value("mend", "")});
  }
}

std::string how_to_reach(const std::string& cause) {
  const auto says = [&](const char* words) { return cause.find(words) != std::string::npos; };
  if (says("certificate")) return "trust its authority (--authority FILE or WAYFUSE_AUTHORITY), and call it by a name in its certificate";
  if (says("refused") || says("connect to server")) return "start it (systemctl start wayfused), or name another with --server or WAYFUSE_SERVER";
  if (says("resolve")) return "check the name, or /etc/hosts and the DNS server";
  if (says("wrong version") || says("Empty reply") || says("SSL") || says("Received HTTP/0.9")) return "http:// and https:// may be mixed up in --server";
  return "check the network between here and there, and the firewall";
}

// True = it answers.
bool examine_reach(const Connection& connection, Diagnoses& found) {
  const auto reply = exchange(connection, "GET", "/healthz");
  if (!reply) {
    found.push_back({"reachable", "error", reply.fault().cause, how_to_reach(reply.fault().cause)});
    return false;
  }
  if (reply->status != 200) {
    found.push_back({"reachable", "error", connection.server + " answers HTTP " + std::to_string(reply->status), "something else listens there, or a proxy in front is not set up"});
    return false;
  }
  found.push_back({"reachable", "good", connection.server + " answers", ""});
  const auto ready = exchange(connection, "GET", "/readyz");
  if (ready && ready->status == 200) {
    found.push_back({"ready", "good", "takes sessions", ""});
  } else {
    found.push_back({"ready", "error", "takes no sessions: " + (ready ? ready->body : ready.fault().cause), "wait while it starts or drains; else its log says why (journalctl -u wayfused)"});
  }
  const auto version = exchange(connection, "GET", "/v1/version");
  const Json parsed = version ? Json::parse(version->body, nullptr, false) : Json();
  const std::string theirs = parsed.is_object() ? parsed.value("version", "?") : "?";
  const bool same = theirs == WAYFUSE_VERSION;
  found.push_back({"version", same ? "good" : "warning", "server " + theirs + ", command line " WAYFUSE_VERSION, same ? "" : "upgrade the older one"});
  return true;
}

// A building whose newest backup is old, or behind its survey by a while, is one disk away from being gone.
void examine_backups(const Connection& connection, const Json& building, Diagnoses& found) {
  constexpr std::int64_t kOld_us = std::int64_t{30} * 86'400 * 1'000'000;
  const std::string id = building.contains("id") ? building["id"].dump() : std::string();
  const auto reply = exchange(connection, "GET", "/v1/buildings/" + id + "/backups");
  if (!reply || reply->status != 200) return;  // an older server does not say
  const Json parsed = Json::parse(reply->body, nullptr, false);
  if (!parsed.is_object() || !parsed.contains("backups") || parsed.value("survey_version", 0) == 0) return;
  const std::string name = building.value("name", "?"), mend = "wayfuse backup " + id + " FILE, kept on another machine";
  const std::int64_t now_us = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  if (parsed["backups"].empty()) {
    found.push_back({"backups", "warning", name + " was never backed up", mend});
  } else if (now_us - parsed["backups"][0].value("at_us", now_us) > kOld_us) {
    found.push_back({"backups", "warning", name + " was last backed up more than 30 days ago", mend});
  }
  if (!parsed["verifications"].empty() && !parsed["verifications"][0].value("sound", true)) {
    found.push_back({"backups", "error", name + ": the newest verification found: " + parsed["verifications"][0].value("finding", "?"),
                     "restore the newest sound backup: wayfuse building remove, then wayfuse restore FILE"});
  }
}

void examine_buildings(const Connection& connection, const std::string& body, Diagnoses& found) {
  const Json parsed = Json::parse(body, nullptr, false);
  if (!parsed.is_object()) return;
  const Json& list = parsed.contains("buildings") ? parsed["buildings"] : parsed.contains("items") ? parsed["items"] : Json::array();
  if (list.empty()) found.push_back({"buildings", "warning", "there is no building", "wayfuse building create FILE"});
  for (const Json& building : list) {
    const std::string name = building.value("name", "?");
    if (building.value("survey_version", 1) == 0)
      found.push_back({"buildings", "warning", name + " has no survey: phones get no position there", "survey it, or wayfuse survey upload"});
    examine_backups(connection, building, found);
  }
  if (!list.empty()) found.push_back({"buildings", "good", std::to_string(list.size()) + (list.size() == 1 ? " building" : " buildings"), ""});
}

void examine_key(const Connection& connection, Diagnoses& found) {
  if (connection.key.empty()) {
    found.push_back({"key", "warning", "no key given", "set WAYFUSE_KEY; the first one was shown at the first start or is in server.first_key_file"});
    return;
  }
  const auto admin = exchange(connection, "GET", "/v1/buildings");
  if (!admin) return;
  if (admin->status == 200) {
    found.push_back({"key", "good", "may administer", ""});
    return examine_buildings(connection, admin->body, found);
  }
  if (admin->status == 401) {
    found.push_back({"key", "error", "the key is not known, revoked or expired", "wayfuse key list with an admin key says which; wayfuse key create makes another"});
    return;
  }
  if (admin->status == 429) {
    found.push_back({"key", "error", "too many wrong keys from this address", "wait a minute, then try the right one"});
    return;
  }
  const auto observe = exchange(connection, "GET", "/v1/pipelines");
  const bool observes = observe && observe->status == 200;
  found.push_back({"key", "warning", observes ? "the key may observe, not administer" : "the key may neither administer nor observe",
                   "that is right for phones and screens; for this command line create one with --scope admin"});
}

}  // namespace

std::vector<Diagnosis> examine(const Connection& connection, const DoctorSettings& settings) {
  Diagnoses found;
  examine_machine(settings, found);
  if (examine_reach(connection, found)) examine_key(connection, found);
  return found;
}

int report(const std::vector<Diagnosis>& diagnoses, bool json) {
  const auto count = [&](std::string_view severity) { return std::ranges::count(diagnoses, severity, &Diagnosis::severity); };
  if (json) {
    Json list = Json::array();
    for (const Diagnosis& one : diagnoses) list.push_back({{"check", one.check}, {"severity", one.severity}, {"what", one.what}, {"mend", one.mend}});
    std::cout << Json{{"errors", count("error")}, {"warnings", count("warning")}, {"findings", std::move(list)}}.dump() << "\n";
  } else {
    for (const Diagnosis& one : diagnoses) {
      std::cout << (one.severity == "good" ? "good     " : one.severity == "warning" ? "WARNING  " : "ERROR    ") << one.check << ": " << one.what << "\n";
      if (!one.mend.empty()) std::cout << "         mend: " << one.mend << "\n";
    }
    std::cout << count("error") << " errors, " << count("warning") << " warnings\n";
  }
  return count("error") == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace wayfuse::cli
