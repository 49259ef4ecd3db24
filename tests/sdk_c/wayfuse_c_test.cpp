#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <set>
#include <string>
#include <thread>

#include "tests/fixtures/raw_websocket_server.hpp"
#include "tests/sdk_c/c_calls.h"
#include "wayfuse/proto/codec.hpp"

// The C interface, driven from C (c_calls.c) through the shared library, against a server of the tests' own.
namespace wayfuse {
namespace {

/// Greets, fuses everybody to (3, 4) on floor 2, stores every survey.
void serve(RawPeer& peer) {
  const std::string head = peer.read_head();
  if (head.empty()) return;
  peer.accept_upgrade(head, kSubprotocolCbor);
  const auto say = [&](const ServerMessage& message) { peer.send_frame(2, encode(message, Encoding::kCbor)); };
  while (const auto frame = peer.read_frame()) {
    if (frame->opcode == 8) {
      peer.send_frame(8, frame->payload);
      return;
    }
    const auto message = decode_client_message(frame->payload, Encoding::kCbor);
    if (!message) return;
    if (std::holds_alternative<Hello>(*message)) {
      Welcome welcome;
      welcome.session = "s";
      welcome.tracked = "t";
      welcome.epoch = 1;
      welcome.building = BuildingId{1};
      welcome.pipeline = "p1";
      say(welcome);
    }
    if (const auto* batch = std::get_if<SampleBatch>(&*message)) {
      say(Ack{1, batch->samples.back().sequence});
      Position position;
      if (const auto* motion = std::get_if<MotionReport>(&batch->samples.back().body)) position.position.valid_at = motion->time;
      position.position.building = BuildingId{1};
      position.position.place = {{3, 4}, {2}};
      position.position.floors = {{FloorOrdinal{2}, 1.0}};
      position.position.radius68_m = 1;
      position.position.radius95_m = 2;
      position.applied_through = batch->samples.back().sequence;
      say(position);
    }
    if (const auto* batch = std::get_if<SurveyBatch>(&*message)) {
      say(SurveyAck{batch->idempotency_key, static_cast<std::uint32_t>(batch->points.size()), 1});
    }
  }
}

void wait_a_little() { std::this_thread::sleep_for(std::chrono::milliseconds(2)); }

std::string url_of(const RawServer& server) { return "ws://127.0.0.1:" + std::to_string(server.port()) + "/v1/session"; }

TEST(WayfuseInC, RefusesNullEverywhere) { EXPECT_STREQ(c_null_is_refused(), nullptr); }

TEST(WayfuseInC, ChecksOptionsOfAnyAge) { EXPECT_STREQ(c_options_are_checked(), nullptr); }

TEST(WayfuseInC, NamesBadInput) {
  RawServer server(serve);
  EXPECT_STREQ(c_bad_input_is_named(url_of(server).c_str()), nullptr);
}

TEST(WayfuseInC, TracksFromSensorsToAPosition) {
  RawServer server(serve);
  EXPECT_STREQ(c_tracks(url_of(server).c_str(), wait_a_little), nullptr);
}

TEST(WayfuseInC, SurveysAWalkAndAPoint) {
  RawServer server(serve);
  EXPECT_STREQ(c_surveys(url_of(server).c_str(), wait_a_little), nullptr);
}

TEST(WayfuseInC, ManyPhonesComeAndGo) {
  RawServer server(serve);
  for (int i = 0; i < 20; ++i) {
    wayfuse_options options;
    wayfuse_options_init(&options, sizeof options);
    const std::string url = url_of(server);
    options.url = {url.data(), url.size()};
    options.building = 1;
    wayfuse_phone* phone = nullptr;
    ASSERT_EQ(wayfuse_phone_create(&options, &phone), WAYFUSE_OK);
    ASSERT_EQ(wayfuse_phone_start(phone), WAYFUSE_OK);
    std::thread other([&] { wayfuse_phone_network_changed(phone); });
    for (int n = 0; n < i; ++n) wayfuse_phone_feed_gnss(phone, wayfuse_now_us(), 47, 8, 5);
    other.join();
    ASSERT_EQ(wayfuse_phone_destroy(phone), WAYFUSE_OK);
  }
}

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> part;
  while (pipe && std::fgets(part.data(), part.size(), pipe)) text += part.data();
  if (pipe) pclose(pipe);
  return text;
}

TEST(Libwayfuse, ExportsTheHeaderAndNothingElse) {
  std::set<std::string> declared;
  const std::string header = output_of("grep -oE 'wayfuse_[a-z0-9_]+\\(' " WAYFUSE_SOURCE_DIR "/sdk/include/wayfuse/sdk/wayfuse.h");
  for (std::size_t at = 0, end; (end = header.find("(\n", at)) != std::string::npos; at = end + 2) declared.insert(header.substr(at, end - at));
  std::set<std::string> exported;
  const std::string symbols = output_of("nm -D --defined-only --format=posix " WAYFUSE_SHARED_LIBRARY " | cut -d' ' -f1");
  for (std::size_t at = 0, end; (end = symbols.find('\n', at)) != std::string::npos; at = end + 1) exported.insert(symbols.substr(at, end - at));
  EXPECT_EQ(exported, declared);
  EXPECT_GE(exported.size(), 25u);
}

TEST(Libwayfuse, KeepsItsSizeBudget) {
  // 1.5 MB stripped, OpenSSL not counted (it is a library of the system): the budget for a phone's download.
  const std::string stripped = WAYFUSE_BINARY_DIR "/libwayfuse.stripped";
  ASSERT_EQ(std::system(("strip -o " + stripped + " " WAYFUSE_SHARED_LIBRARY).c_str()), 0);
  const std::string size = output_of("stat -c %s " + stripped);
  EXPECT_LE(std::stol(size), 1'500'000) << size;
}

}  // namespace
}  // namespace wayfuse
