#include "server/config.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "tests/fixtures/scratch_folder.hpp"

namespace wayfuse {
namespace {

TEST(Config, FlagsWinOverTheEnvironmentAndThatOverTheFile) {
  ScratchFolder folder;
  const std::string file = (folder.path() / "wayfused.toml").string();
  std::ofstream(file) << "[listen]\nport = 1\naddress = \"::1\"\n[sessions]\nidle_s = 30.5\n[server]\nworkers = 3\n";
  const char* environment[] = {"WAYFUSE_LISTEN_PORT=2", "WAYFUSE_SERVER_WORKERS=4", "WAYFUSE_DATA=/elsewhere", "HOME=/",
                               nullptr};
  const char* arguments[] = {"wayfused", "--config", file.c_str(), "--listen.port=3"};
  const auto line = read_command_line(arguments, environment);
  ASSERT_TRUE(line) << to_string(line.fault());
  EXPECT_EQ(line->config.net.port, 3);
  EXPECT_EQ(line->config.workers, 4u);
  EXPECT_EQ(line->config.net.address, "::1");
  EXPECT_EQ(line->config.sessions.idle_deadline, std::chrono::milliseconds(30500));
}

TEST(Config, NamesWhatIsWrong) {
  ServerConfig config;
  EXPECT_EQ(set(config, "listen.ports", "1").fault().field, "listen.ports");
  EXPECT_EQ(set(config, "server.drain_s", "nan").fault().code, FaultCode::kOutOfRange);
  EXPECT_EQ(set(config, "listen.plain_beyond_loopback", "yes").fault().code, FaultCode::kOutOfRange);
  EXPECT_EQ(set(config, "log.level", "loud").fault().code, FaultCode::kUnknownName);
  const char* misspelt[] = {"WAYFUSE_LISTEN_PROT=2", nullptr};
  const char* arguments[] = {"wayfused"};
  EXPECT_EQ(read_command_line(arguments, misspelt).fault().field, "WAYFUSE_LISTEN_PROT");
  const char* missing[] = {"wayfused", "--listen.port"};
  EXPECT_EQ(read_command_line(missing, nullptr).fault().code, FaultCode::kMissingField);
  const char* no_file[] = {"wayfused", "--config", "/nowhere/wayfused.toml"};
  EXPECT_FALSE(read_command_line(no_file, nullptr));
}

TEST(Config, EveryDefaultIsWithinItsOwnRange) {
  const ServerConfig standard;
  std::set<std::string> environment;
  for (const ConfigSetting& setting : config_settings()) {
    std::string text = setting.show(standard);
    if (text.front() == '"') text = text.substr(1, text.size() - 2);
    ServerConfig config;
    const auto taken = setting.take(config, setting.key, text);
    EXPECT_TRUE(taken) << setting.key << " = " << text;
    EXPECT_EQ(setting.show(config), setting.show(standard));
    EXPECT_TRUE(environment.insert(environment_name(setting.key)).second);
    EXPECT_NE(help_text().find(setting.key), std::string::npos);
  }
}

TEST(Config, PrintedItReadsBackAsItself) {
  ServerConfig config;
  ASSERT_TRUE(set(config, "server.data", "/srv/a \"b\" \\c"));
  ASSERT_TRUE(set(config, "listen.port", "4711"));
  ASSERT_TRUE(set(config, "listen.plain_beyond_loopback", "true"));
  ScratchFolder folder;
  const std::string file = (folder.path() / "wayfused.toml").string();
  std::ofstream(file) << toml_text(config);
  const char* arguments[] = {"wayfused", "--config", file.c_str()};
  const auto line = read_command_line(arguments, nullptr);
  ASSERT_TRUE(line) << to_string(line.fault());
  for (const ConfigSetting& setting : config_settings()) EXPECT_EQ(setting.show(line->config), setting.show(config)) << setting.key;
}

// Every value it prints is valid where it stands, also those commented out: an operator uncomments them.
TEST(Config, EveryKeyOfThePrintedFileCanBeUncommented) {
  std::istringstream text(toml_text(ServerConfig{}));
  std::string whole;
  std::size_t keys = 0;
  for (std::string line; std::getline(text, line);) {
    const bool key = line.starts_with("# ") && line.find(" = ") != std::string::npos && line.find(' ', 2) == line.find(" = ");
    whole += (key ? line.substr(2) : line) + "\n";
    keys += key;
  }
  EXPECT_EQ(keys, config_settings().size());
  ScratchFolder folder;
  const std::string file = (folder.path() / "wayfused.toml").string();
  std::ofstream(file) << whole;
  const char* arguments[] = {"wayfused", "--config", file.c_str()};
  const auto line = read_command_line(arguments, nullptr);
  EXPECT_TRUE(line) << to_string(line.fault());
}

}  // namespace
}  // namespace wayfuse
