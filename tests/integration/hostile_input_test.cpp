// Broken frames and broken requests: each gets its answer, and the server serves on [SAFETY R9, R10].
#include <gtest/gtest.h>

#include "tests/integration/running_server.hpp"

namespace wayfuse {
namespace {

class HostileInput : public AnyServer {
 protected:
  void SetUp() override {
    start({"--limits.handshake_s", "1"});
    make_building("Hall");
  }
  void TearDown() override { EXPECT_EQ(http(where(), "GET", "/healthz").status, 200) << "the server no longer answers"; }

  RawWebsocket greeted(std::string_view spoken = kSubprotocolJson) {
    RawWebsocket client(where(), key, spoken);
    client.send(hello(Role::kTrack, building));
    EXPECT_TRUE(client.expect<Welcome>());
    return client;
  }
  int status_of(const std::string& request) {
    RawSocket socket(where());
    socket.send(request);
    const std::string answer = socket.read_until("\r\n", 5).value_or("HTTP/1.1 0");
    return std::atoi(answer.c_str() + 9);
  }
};

TEST_F(HostileInput, BrokenWebsocketFramesEndTheConnectionWithTheirCode) {
  struct Case {
    const char* what;
    std::string bytes;
    int code;
  };
  const std::string mask(4, '\0');
  const std::vector<Case> cases = {
      {"not masked", std::string("\x81\x02{}", 4), 1002},
      {"reserved bit set", std::string("\xc1\x80", 2) + mask, 1002},
      {"reserved opcode", std::string("\x83\x80", 2) + mask, 1002},
      {"continuation of nothing", std::string("\x80\x80", 2) + mask, 1002},
      {"fragmented ping", std::string("\x09\x80", 2) + mask, 1002},
      {"ping of 126 bytes", std::string("\x89\xfe\x00\x7e", 4) + mask + std::string(126, 'x'), 1002},
      {"close with one byte", std::string("\x88\x81", 2) + mask + "x", 1002},
      {"close with a code nobody may send", std::string("\x88\x82", 2) + mask + std::string("\x03\xed", 2), 1002},
      {"text that is not UTF-8", std::string("\x81\x82", 2) + mask + "\xc3\x28", 1007},
      {"a message longer than 64 KiB",
       std::string("\x81\xff\x00\x00\x00\x00\x00\x01\x00\x01", 10) + mask + std::string(65537, ' '), 1009},
  };
  for (const Case& broken : cases) {
    RawWebsocket client = greeted();
    client.socket().send(broken.bytes);
    EXPECT_EQ(client.close_code(5), broken.code) << broken.what;
  }
}

TEST_F(HostileInput, MessagesThatDoNotDecodeAreAnsweredOrEndTheSession) {
  RawWebsocket garbage = greeted();
  garbage.send_frame(1, "{\"type\":");
  EXPECT_EQ(garbage.expect<FaultReport>()->fault.code, FaultCode::kMalformed);
  EXPECT_EQ(garbage.close_code(), 1003);

  RawWebsocket wrong_kind = greeted(kSubprotocolCbor);
  wrong_kind.send_frame(1, "{}");
  EXPECT_EQ(wrong_kind.close_code(), 1003);

  RawWebsocket absurd = greeted();
  absurd.send_frame(
      1,
      R"({"type":"samples","first_sequence":1,"samples":[{"kind":"scan","time_us":1,"readings":[{"bssid":"00:00:00:00:00:01","rss_dbm":1e999}]}]})");
  const auto report = absurd.expect<FaultReport>();
  ASSERT_TRUE(report);
  EXPECT_EQ(face_of(report->fault.code).close_code, 0) << to_string(report->fault);
  absurd.send_frame(1, R"({"type":"from the future"})");
  EXPECT_EQ(absurd.expect<FaultReport>()->fault.code, FaultCode::kUnknownType);
  absurd.send(scans(1, 1));  // the session is as it was
  EXPECT_EQ(absurd.expect<Ack>()->through, 1u);
}

TEST_F(HostileInput, FragmentsAndControlFramesBetweenThemArePutTogether) {
  RawWebsocket client = greeted();
  const std::string text = encode(ClientMessage(scans(1, 1)), Encoding::kJson);
  const auto piece = [&](int first_byte, std::string_view payload) {
    ASSERT_LT(payload.size(), 126u);
    client.socket().send(std::string(1, static_cast<char>(first_byte)) + static_cast<char>(0x80 | payload.size()) +
                         std::string(4, '\0') + std::string(payload));
  };
  piece(0x01, text.substr(0, 20));
  client.send_frame(9, "are you there");
  for (std::size_t at = 20; at < text.size(); at += 100)
    piece(at + 100 < text.size() ? 0x00 : 0x80, std::string_view(text).substr(at, 100));
  EXPECT_EQ(client.expect<Ack>()->through, 1u);
}

TEST_F(HostileInput, UpgradesWithoutAProtocolOrElsewhereAreRefused) {
  EXPECT_EQ(RawWebsocket(where(), key, "").status(), 400);
  EXPECT_EQ(RawWebsocket(where(), key, "wayfuse.v9.xml").status(), 400);
  EXPECT_EQ(RawWebsocket(where(), key, kSubprotocolJson, "/v1/elsewhere").status(), 404);
  EXPECT_EQ(RawWebsocket(where(), key, "soap, wayfuse.v1.json").status(), 101);
}

TEST_F(HostileInput, BrokenRequestsAreRefused) {
  const std::string host = "Host: x\r\n";
  EXPECT_EQ(status_of("GARBAGE\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET healthz HTTP/1.1\r\n" + host + "\r\n"), 400);
  EXPECT_EQ(status_of("GET /%zz HTTP/1.1\r\n" + host + "\r\n"), 400);
  EXPECT_EQ(status_of("GET /a/../b HTTP/1.1\r\n" + host + "\r\n"), 400);
  EXPECT_EQ(status_of("GET /nowhere HTTP/1.1\r\n" + host + "\r\n"), 404);
  EXPECT_EQ(status_of("DELETE /healthz HTTP/1.1\r\n" + host + "\r\n"), 405);
  EXPECT_EQ(status_of("POST /v1/buildings HTTP/1.1\r\n" + host + "Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n{}"),
            400);
  EXPECT_EQ(status_of("POST /v1/buildings HTTP/1.1\r\n" + host + "Content-Length: 99999999\r\n\r\n"), 413);
  EXPECT_EQ(status_of("GET /healthz HTTP/1.1\r\n" + host + "X: " + std::string(20000, 'x') + "\r\n\r\n"), 431);
  std::string crowd = "GET /healthz HTTP/1.1\r\n" + host;
  for (int i = 0; i < 120; ++i) crowd += "X" + std::to_string(i) + ": 1\r\n";
  EXPECT_EQ(status_of(crowd + "\r\n"), 431);
}

TEST_F(HostileInput, SlowClientsAreCutAtTheirDeadline) {
  RawSocket silent(where());
  RawSocket slow(where());
  slow.send("GET /healthz HTTP/1.1\r\nHost:");
  EXPECT_TRUE(silent.read_to_end(30));  // a server elsewhere has the standard deadline
  EXPECT_TRUE(slow.read_to_end(30));
}

class HostileInputOfItsOwn : public HostileInput {
 protected:
  void SetUp() override {
    if (outside()) GTEST_SKIP() << "counts what only it does, and WAYFUSE_TEST_SERVER names a server with other clients";
    HostileInput::SetUp();
  }
  void TearDown() override {
    if (!outside()) HostileInput::TearDown();
  }
};

TEST_F(HostileInputOfItsOwn, AThousandSlowClientsKeepNobodyOutAndLeaveNothingBehind) {
  std::vector<RawSocket> slow;
  for (int i = 0; i < 1000; ++i) {
    slow.emplace_back(where());
    slow.back().send("GET / HT");
  }
  EXPECT_EQ(http(where(), "GET", "/healthz").status, 200);
  for (RawSocket& socket : slow) EXPECT_TRUE(socket.read_to_end(20));
  std::string metrics;
  const auto alone = [&] { return metrics.find("wayfuse_connections 1\n") != std::string::npos; };  // the one that asks
  for (int i = 0; i < 1'000 && !alone(); ++i) metrics = http(where(), "GET", "/metrics", key).body;
  EXPECT_TRUE(alone()) << metrics;
  EXPECT_NE(metrics.find("wayfuse_handshake_timeouts_total 1000\n"), std::string::npos);
}

TEST_F(HostileInputOfItsOwn, OutOfDescriptorsItTurnsCallersAwayAndServesOn) {
  server->allow_descriptors(64);
  std::vector<RawSocket> crowd;
  for (int i = 0; i < 150; ++i) crowd.emplace_back(where());
  for (RawSocket& socket : crowd) EXPECT_TRUE(socket.read_to_end(20));  // turned away at once, or at the deadline
  const std::string metrics = http(where(), "GET", "/metrics", key).body;
  EXPECT_EQ(metrics.find("wayfuse_accept_failures_total 0\n"), std::string::npos);
}

TEST_F(HostileInputOfItsOwn, AClientThatAsksAndNeverReadsIsClosed) {
  server.reset();
  start({"--limits.frames_per_second", "1000000", "--limits.frames_burst", "1000000"});
  RawWebsocket greedy = greeted();
  const std::string text = encode(ClientMessage(ClockProbe{}), Encoding::kJson);
  const std::string frame = std::string("\x81", 1) + static_cast<char>(0x80 | text.size()) + std::string(4, '\0') + text;
  std::string many;
  for (int i = 0; i < 1000; ++i) many += frame;
  bool alive = true;
  for (int i = 0; i < 500 && alive; ++i) alive = greedy.socket().send(many);
  EXPECT_FALSE(alive) << "half a million unread answers, and still open";
  const std::string metrics = http(where(), "GET", "/metrics", key).body;
  EXPECT_NE(metrics.find("wayfuse_slow_consumers_closed_total 1\n"), std::string::npos);
}

}  // namespace
}  // namespace wayfuse
