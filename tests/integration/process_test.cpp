// The program itself: configuration, TLS, a second one on the same folder, a foreign library.
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/integration/running_server.hpp"

namespace wayfuse {
namespace {

class Process : public RunningServer {
 protected:
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  int refused(const std::vector<std::string>& flags) {
    server.reset();
    server = std::make_unique<ServerProcess>(data(), flags);
    EXPECT_FALSE(server->ready());
    return server->wait(10).value_or(-1);
  }
  void make_certificate(const std::string& name) const {
    const std::string command =
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=" + name +
        " -addext subjectAltName=IP:127.0.0.1 -keyout " + path("key.pem") + " -out " + path("certificate.pem") + " 2>/dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0);
  }
  int curl(const std::string& more) const {
    return std::system(("curl -s -o " + path("answer") + " --max-time 10 --cacert " + path("certificate.pem") + " " + more +
                        " https://127.0.0.1:" + std::to_string(port()) + "/healthz")
                           .c_str());
  }
};

TEST_F(Process, UnknownAndBadKeysAreRefusedByName) {
  EXPECT_EQ(refused({"--listen.prot", "1"}), 2);
  EXPECT_NE(server->errors().find("listen.prot: there is no such key; did you mean listen.p"), std::string::npos)
      << server->errors();
  EXPECT_EQ(refused({"--listen.port", "70000"}), 2);
  EXPECT_NE(server->errors().find("listen.port: 70000 is not a number in 0..65535"), std::string::npos) << server->errors();
  write("wayfused.toml", "[sessions]\nmost = 5\ncolour = \"red\"\n");
  EXPECT_EQ(refused({"--config", path("wayfused.toml")}), 2);
  EXPECT_NE(server->errors().find("sessions.colour"), std::string::npos) << server->errors();
}

TEST_F(Process, PlainHttpStaysOnLoopbackUnlessAllowed) {
  EXPECT_EQ(refused({"--listen.address", "0.0.0.0"}), 1);
  EXPECT_NE(server->errors().find("is not loopback"), std::string::npos) << server->errors();
  start({"--listen.address", "0.0.0.0", "--listen.plain_beyond_loopback", "true"});
  EXPECT_EQ(http(port(), "GET", "/readyz").status, 200);
}

TEST_F(Process, ASecondOneOnTheSameFolderIsRefused) {
  start();
  ServerProcess second(data());
  EXPECT_FALSE(second.ready());
  EXPECT_EQ(second.wait(10), 1);
  EXPECT_NE(second.errors().find("store_busy"), std::string::npos) << second.errors();
}

TEST_F(Process, TheFirstKeyIsShownOnceOrWrittenToItsFile) {
  start({"--server.first_key_file", path("key")});
  EXPECT_TRUE(server->key().empty());
  std::ifstream(path("key")) >> key;
  EXPECT_EQ(http(port(), "GET", "/v1/buildings", key).status, 200);
  server->signal(SIGTERM);
  EXPECT_EQ(server->wait(10), 0);
  start();
  EXPECT_TRUE(server->key().empty());
  EXPECT_EQ(http(port(), "GET", "/v1/buildings", key).status, 200);
}

TEST_F(Process, TlsFromOnePointTwoAndANewCertificateAtSighup) {
  make_certificate("one");
  start({"--tls.certificate", path("certificate.pem"), "--tls.key", path("key.pem")});
  EXPECT_EQ(curl(""), 0);
  EXPECT_EQ(curl("--tls-max 1.2 --tlsv1.2"), 0);
  EXPECT_NE(curl("--tls-max 1.1 --tlsv1.0 --ciphers DEFAULT@SECLEVEL=0"), 0);
  EXPECT_NE(curl("--tls-max 1.2 --ciphers AES128-SHA"), 0);  // not AEAD
  EXPECT_EQ(http(port(), "GET", "/healthz").status, 0);      // plain on the TLS port
  make_certificate("two");
  EXPECT_NE(curl(""), 0);  // the old one is still served
  server->signal(SIGHUP);
  int served = 1;
  for (int i = 0; i < 100 && served != 0; ++i) served = curl("");
  EXPECT_EQ(served, 0);
}

TEST_F(Process, SighupTakesTheLogLevelAndNamesWhatWaitsForARestart) {
  write("wayfused.toml", "[log]\nlevel = \"info\"\n[sessions]\nidle_s = 600\n");
  start({"--config", path("wayfused.toml")});
  write("wayfused.toml", "[log]\nlevel = \"warn\"\n[sessions]\nidle_s = 60\n");
  server->signal(SIGHUP);
  server->signal(SIGTERM);  // pending signals are taken by number: SIGHUP first
  EXPECT_EQ(server->wait(10), 0);
  EXPECT_NE(server->errors().find(R"("event":"restart_needed","key":"sessions.idle_s")"), std::string::npos) << server->errors();
  EXPECT_EQ(server->errors().find("draining"), std::string::npos) << "below the new level";
  write("wayfused.toml", "[sessions]\ncolour = \"red\"\n");
  EXPECT_EQ(refused({"--config", path("wayfused.toml")}), 2);
}

TEST_F(Process, ABrokenFileAtSighupChangesNothing) {
  write("wayfused.toml", "");
  start({"--config", path("wayfused.toml")});
  write("wayfused.toml", "[sessions]\ncolour = \"red\"\n");
  server->signal(SIGHUP);
  EXPECT_EQ(http(where(), "GET", "/readyz").status, 200);
  server->signal(SIGTERM);
  EXPECT_EQ(server->wait(10), 0);
  EXPECT_NE(server->errors().find("reload_failed"), std::string::npos) << server->errors();
  EXPECT_NE(server->errors().find("sessions.colour"), std::string::npos) << server->errors();
}

// Plays systemd: a datagram socket that hears how the server stands.
TEST_F(Process, TheServiceManagerIsToldHowItStands) {
  const int manager = ::socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path("notify");
  name.copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(manager, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const auto heard = [&] {
    char text[64] = {};
    pollfd waited{manager, POLLIN, 0};
    if (::poll(&waited, 1, 10'000) == 1) (void)!::recv(manager, text, sizeof text - 1, 0);
    return std::string(text);
  };
  ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
  start();
  ::unsetenv("NOTIFY_SOCKET");
  EXPECT_EQ(heard(), "READY=1");
  server->signal(SIGHUP);
  EXPECT_EQ(heard(), "RELOADING=1");
  EXPECT_EQ(heard(), "READY=1");
  server->signal(SIGTERM);
  EXPECT_EQ(heard(), "STOPPING=1");
  EXPECT_EQ(server->wait(10), 0);
  ::close(manager);
}

TEST_F(Process, TheDoctorFindsWhatIsWrongAndSaysHowToMendIt) {
  const std::string binaries = WAYFUSE_BINARY_DIR;
  const auto doctor = [&](const std::string& url, const std::string& with_key, const std::string& config) {
    const std::string command = "WAYFUSE_KEY=" + with_key + " " + binaries + "/admin/wayfuse --server " + url + " --json doctor --user '' --wayfused " +
                                binaries + "/server/wayfused --config " + path(config) + " >" + path("said") + " 2>&1";
    const int status = std::system(command.c_str());
    std::stringstream text;
    text << std::ifstream(path("said")).rdbuf();
    return std::to_string(WEXITSTATUS(status)) + " " + text.str();
  };
  start();
  const std::string url = "http://127.0.0.1:" + std::to_string(port());
  write("good.toml", "[server]\ndata = \"" + data() + "\"\n[listen]\nport = " + std::to_string(port()) + "\n");
  const std::string healthy = doctor(url, key, "good.toml");
  EXPECT_EQ(healthy.substr(0, 13), R"(0 {"errors":0)") << healthy;
  EXPECT_NE(healthy.find("is in use, by the server that runs"), std::string::npos) << healthy;
  EXPECT_NE(healthy.find("there is no building"), std::string::npos) << healthy;

  const std::string wrong_key = doctor(url, "wf_wrong", "good.toml");
  EXPECT_EQ(wrong_key.substr(0, 13), R"(1 {"errors":1)") << wrong_key;
  EXPECT_NE(wrong_key.find("not known, revoked or expired"), std::string::npos) << wrong_key;
  write("bad.toml", "[sessions]\ncolour = \"red\"\n");
  EXPECT_NE(doctor(url, key, "bad.toml").find("sessions.colour"), std::string::npos);
  server->signal(SIGTERM);
  EXPECT_EQ(server->wait(10), 0);
  EXPECT_NE(doctor(url, key, "good.toml").find("systemctl start wayfused"), std::string::npos);
}

TEST_F(Process, AForeignLibrarySpeaksTheProtocol) {
  if (std::system("/usr/bin/python3 -c 'import websockets' 2>/dev/null") != 0) {
    GTEST_SKIP() << "SKIPPED LOUDLY: python3-websockets is not installed";
  }
  start();
  make_building("Hall");
  survey(1);
  const std::string script = std::string(WAYFUSE_SOURCE_DIR) + "/tests/integration/foreign_client.py";
  EXPECT_EQ(std::system(("/usr/bin/python3 " + script + " " + std::to_string(port()) + " " + key).c_str()), 0);
}

}  // namespace
}  // namespace wayfuse
