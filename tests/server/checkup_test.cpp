#include "server/checkup.hpp"

#include <gtest/gtest.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "tests/fixtures/scratch_folder.hpp"

namespace wayfuse {
namespace {

class Checkup : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder.path() / "data");
    std::filesystem::permissions(folder.path() / "data", std::filesystem::perms::owner_all);
    config.data = folder.path() / "data";
    config.net.port = 0;
  }
  // The worst that one check says.
  Finding found(std::string_view check) const {
    Finding worst{check, Severity::kGood, "", ""};
    for (const Finding& finding : check_up(config)) {
      if (finding.check == check && finding.severity >= worst.severity) worst = finding;
    }
    return worst;
  }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  void make_certificate(const std::string& name, int days) {
    const std::string command = "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days " + std::to_string(days) +
                                " -subj /CN=x -addext subjectAltName=DNS:maps.example -keyout " + path(name + ".key") + " -out " + path(name + ".pem") +
                                " 2>/dev/null && chmod 0600 " + path(name + ".key");
    ASSERT_EQ(std::system(command.c_str()), 0);
  }
  // `openssl ca` is the tool that takes an end in the past.
  void make_expired_certificate(const std::string& name) {
    std::ofstream(path("ca.cnf")) << "[ca]\ndefault_ca=d\n[d]\ndatabase=" << path("index") << "\nserial=" << path("serial") << "\nnew_certs_dir="
                                  << folder.path().string() << "\npolicy=p\ndefault_md=sha256\n[p]\ncommonName=supplied\n";
    std::ofstream(path("index")).flush();
    std::ofstream(path("serial")) << "01\n";
    const std::string command = "cd " + folder.path().string() + " && openssl req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -subj /CN=x -keyout " +
                                name + ".key -out request 2>/dev/null && chmod 0600 " + name + ".key && openssl ca -batch -selfsign -config ca.cnf -keyfile " + name +
                                ".key -in request -startdate 20200101000000Z -enddate 20200201000000Z -notext -out " + name + ".pem 2>/dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0);
  }
  void use(const std::string& certificate, const std::string& key) {
    config.net.tls_certificate = path(certificate);
    config.net.tls_key = path(key);
  }

  ScratchFolder folder;
  ServerConfig config;
};

TEST_F(Checkup, AHealthyOneServesAndNothingIsChanged) {
  const auto findings = check_up(config);
  EXPECT_TRUE(serves(findings)) << to_text(findings);
  EXPECT_TRUE(std::filesystem::is_empty(config.data));
  for (const Finding& finding : findings) EXPECT_EQ(finding.mend.empty(), finding.severity == Severity::kGood) << finding.what;
}

TEST_F(Checkup, TheDataFolderMustBeAFolderAndClosedToOthers) {
  std::filesystem::permissions(config.data, std::filesystem::perms::all);
  EXPECT_EQ(found("data_folder").severity, Severity::kWarning);
  std::ofstream(config.data / "building-3.sqlite.corrupt") << "x";
  EXPECT_NE(found("quarantine").what.find("building-3"), std::string::npos);
  std::ofstream(path("file")) << "x";
  config.data = folder.path() / "file";
  EXPECT_EQ(found("data_folder").severity, Severity::kError);
  config.data = folder.path() / "not" / "yet";
  EXPECT_EQ(found("data_folder").severity, Severity::kGood);
  EXPECT_FALSE(std::filesystem::exists(config.data));
}

TEST_F(Checkup, APortInUseIsAFaultUnlessOurOwnServerHasIt) {
  const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  ASSERT_EQ(::bind(listener, reinterpret_cast<sockaddr*>(&address), length), 0);
  ASSERT_EQ(::listen(listener, 1), 0);
  ::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &length);
  config.net.port = ntohs(address.sin_port);
  EXPECT_EQ(found("port").severity, Severity::kError);
  EXPECT_NE(found("port").mend.find("ss -ltnp"), std::string::npos);

  const int lock = ::open((config.data / "server.sqlite.lock").c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(::write(lock, "4711                ", 20), 20);
  ASSERT_EQ(::flock(lock, LOCK_EX), 0);
  EXPECT_NE(found("database_lock").what.find("process 4711"), std::string::npos);
  EXPECT_EQ(found("port").severity, Severity::kGood);
  ::close(lock);
  ::close(listener);
}

TEST_F(Checkup, PlainHttpBeyondLoopbackIsAFault) {
  config.net.address = "0.0.0.0";
  EXPECT_EQ(found("port").severity, Severity::kError);
  config.net.plain_beyond_loopback = true;
  EXPECT_EQ(found("port").severity, Severity::kGood);
  config.net.address = "localhost";
  EXPECT_NE(found("port").what.find("is not an IP address"), std::string::npos);
}

TEST_F(Checkup, CertificatesThatExpireMismatchOrAreOpenAreNamed) {
  make_certificate("good", 300);
  make_certificate("soon", 10);
  make_expired_certificate("over");
  use("good.pem", "good.key");
  EXPECT_EQ(found("tls").severity, Severity::kGood);
  EXPECT_NE(found("tls").what.find("maps.example"), std::string::npos);
  use("soon.pem", "soon.key");
  EXPECT_EQ(found("tls").severity, Severity::kWarning);
  use("over.pem", "over.key");
  EXPECT_NE(found("tls").what.find("expired"), std::string::npos);
  use("good.pem", "soon.key");
  EXPECT_NE(found("tls").what.find("is not the key of"), std::string::npos);
  use("good.pem", "nowhere.key");
  EXPECT_EQ(found("tls").severity, Severity::kError);
  use("good.key", "good.key");
  EXPECT_NE(found("tls").what.find("no PEM certificate"), std::string::npos);
  use("good.pem", "good.key");
  std::filesystem::permissions(path("good.key"), std::filesystem::perms::others_read, std::filesystem::perm_options::add);
  EXPECT_EQ(found("tls").severity, Severity::kWarning);
  config.net.tls_key.clear();
  EXPECT_EQ(found("tls").severity, Severity::kError);
}

TEST_F(Checkup, LimitsBeyondTheMachineAreWarnedOf) {
  config.net.memory_budget_bytes = std::uint64_t{1} << 46;
  EXPECT_EQ(found("memory").severity, Severity::kWarning);
  config.net.connections_most = 1'000'000'000;
  EXPECT_EQ(found("descriptors").severity, Severity::kWarning);
}

TEST_F(Checkup, AFirstKeyLeftOpenIsWarnedOf) {
  config.first_key_file = path("key");
  std::ofstream(path("key")) << "wf_x";
  std::filesystem::permissions(path("key"), std::filesystem::perms::owner_all | std::filesystem::perms::group_read);
  EXPECT_EQ(found("first_key_file").severity, Severity::kWarning);
}

}  // namespace
}  // namespace wayfuse
