#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

#include "tests/fixtures/scratch_folder.hpp"
#include "tests/integration/raw_client.hpp"
#include "tests/integration/server_process.hpp"
#include "tests/locating/plan.hpp"

namespace wayfuse {

/// A server to test: the one that WAYFUSE_TEST_SERVER names (its URL; WAYFUSE_TEST_KEY an admin key, WAYFUSE_TEST_AUTHORITY the PEM
/// file to trust), else a wayfused of its own on a folder of its own, with its first key.
class AnyServer : public testing::Test {
 protected:
  static const char* outside() { return std::getenv("WAYFUSE_TEST_SERVER"); }
  void start(const std::vector<std::string>& flags = {}) {
    if (outside()) {
      const char* trusted = std::getenv("WAYFUSE_TEST_AUTHORITY");
      const char* admin = std::getenv("WAYFUSE_TEST_KEY");
      where_ = Endpoint(outside(), trusted ? trusted : "");
      key = admin ? admin : "";
      ASSERT_EQ(http(where(), "GET", "/readyz").status, 200) << outside() << " is not ready";
      return;
    }
    server.reset();
    server = std::make_unique<ServerProcess>(data(), flags);
    if (!server->key().empty()) key = server->key();
    ASSERT_TRUE(server->ready()) << (server->wait(2), server->errors());
    where_ = Endpoint(server->port());
  }
  std::string data() const { return (folder.path() / "data").string(); }
  const Endpoint& where() const { return where_; }
  std::uint16_t port() const { return where_.port; }

  /// Makes a building through the API; its number is `building`.
  void make_building(const std::string& name) {
    const auto answer = http(where(), "POST", "/v1/buildings", key, R"({"name":")" + name + R"(","pipeline":"nn"})");
    ASSERT_EQ(answer.status, 201) << answer.body;
    const std::string mark = "\"id\":";
    building = std::strtoull(answer.body.c_str() + answer.body.find(mark) + mark.size(), nullptr, 10);
    ASSERT_GT(building, 0u) << answer.body;
  }
  static Plan hall() { return Plan({"A....B....C", "...........", "D....E....F"}, 4.0); }
  static Hello hello(Role role, std::uint64_t asked) {
    Hello hello;
    hello.role = role;
    hello.building = BuildingId{asked};
    hello.device_model = "Raw";
    hello.app = "integration/1";
    return hello;
  }
  static SurveyBatch batch(const std::string& idempotency_key) {
    SurveyBatch batch{idempotency_key, hall().survey(1)};
    for (ReferencePoint& point : batch.points) point.device_model = "Raw", point.walk = idempotency_key;
    return batch;
  }
  static SampleBatch scans(std::uint64_t first, int count) {
    SampleBatch batch;
    for (int i = 0; i < count; ++i) {
      const std::uint64_t number = first + static_cast<std::uint64_t>(i);
      batch.samples.push_back({number, hall().scan_at({20, 4}, PhoneTime(std::chrono::seconds(number)))});
    }
    return batch;
  }
  void survey(std::uint64_t surveyed) {
    RawWebsocket surveyor(where(), key);
    surveyor.send(hello(Role::kSurvey, surveyed));
    surveyor.send(batch("first"));
    ASSERT_TRUE(surveyor.expect<SurveyAck>());
    await_map(surveyed, 1);
  }
  /// Durable is not yet on the map: that is built off-strand and swapped in.
  void await_map(std::uint64_t surveyed, std::uint64_t version) {
    const std::string wanted = "\"radio_map_version\":" + std::to_string(version);
    std::string described;
    for (int i = 0; i < 10'000 && described.find(wanted) == std::string::npos; ++i) {
      described = http(where(), "GET", "/v1/buildings/" + std::to_string(surveyed), key).body;
    }
    ASSERT_NE(described.find(wanted), std::string::npos) << described;
  }

  ScratchFolder folder;
  std::unique_ptr<ServerProcess> server;
  std::string key;
  std::uint64_t building = 0;

 private:
  Endpoint where_{std::uint16_t{0}};
};

/// The same for tests that configure, signal or restart their server: they skip where it runs elsewhere.
class RunningServer : public AnyServer {
 protected:
  void SetUp() override {
    if (outside()) GTEST_SKIP() << "needs a server of its own, and WAYFUSE_TEST_SERVER names another";
  }
};

}  // namespace wayfuse
