#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "tests/fixtures/scratch_folder.hpp"
#include "tests/integration/raw_client.hpp"
#include "tests/integration/server_process.hpp"
#include "tests/locating/plan.hpp"

namespace wayfuse {

/// A wayfused on a folder of its own, with its first key.
class RunningServer : public testing::Test {
 protected:
  void start(const std::vector<std::string>& flags = {}) {
    server.reset();
    server = std::make_unique<ServerProcess>(data(), flags);
    if (!server->key().empty()) key = server->key();
    ASSERT_TRUE(server->ready()) << (server->wait(2), server->errors());
  }
  std::string data() const { return (folder.path() / "data").string(); }
  std::uint16_t port() const { return server->port(); }

  /// Makes a building through the API; the first one has id 1.
  void make_building(const std::string& name) {
    const auto answer = http(port(), "POST", "/v1/buildings", key, R"({"name":")" + name + R"(","pipeline":"nn"})");
    ASSERT_EQ(answer.status, 201) << answer.body;
  }
  static Plan hall() { return Plan({"A....B....C", "...........", "D....E....F"}, 4.0); }
  static Hello hello(Role role, std::uint64_t building) {
    Hello hello;
    hello.role = role;
    hello.building = BuildingId{building};
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
  void survey(std::uint64_t building) {
    RawWebsocket surveyor(port(), key);
    surveyor.send(hello(Role::kSurvey, building));
    surveyor.send(batch("first"));
    ASSERT_TRUE(surveyor.expect<SurveyAck>());
    // Durable is not yet on the map: that is built off-strand and swapped in.
    const std::string wanted = "\"radio_map_version\":1";
    std::string described;
    for (int i = 0; i < 10'000 && described.find(wanted) == std::string::npos; ++i) {
      described = http(port(), "GET", "/v1/buildings/" + std::to_string(building), key).body;
    }
    ASSERT_NE(described.find(wanted), std::string::npos) << described;
  }

  ScratchFolder folder;
  std::unique_ptr<ServerProcess> server;
  std::string key;
};

}  // namespace wayfuse
