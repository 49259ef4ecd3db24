#include "tests/sdk_link/link_probe.hpp"

#include <sys/socket.h>

#include <atomic>

namespace wayfuse {
namespace {

using namespace std::chrono_literals;

class WebsocketLink : public LinkProbe {};

TEST_F(WebsocketLink, OffersBothEncodingsAndTakesTheServersChoice) {
  for (const Encoding encoding : {Encoding::kCbor, Encoding::kJson}) {
    std::string head;
    RawServer server([&](RawPeer& peer) {
      head = peer.read_head();
      peer.accept_upgrade(head, subprotocol(encoding));
      const auto frame = peer.read_frame();
      if (frame) peer.send_frame(frame->opcode, frame->payload);
      peer.wait_for_end();
    });
    settings.authorization = [] { return "Bearer secret"; };
    opened.clear();
    received.clear();
    open(server);
    ASSERT_TRUE(until_open()) << reason();
    EXPECT_EQ(opened.front(), encoding);
    ASSERT_TRUE(link->send("{}"));
    ASSERT_TRUE(run_until([&] { return !received.empty(); }));
    EXPECT_EQ(received.front(), "{}");
    EXPECT_EQ(header_of(head, "Sec-WebSocket-Protocol"), "wayfuse.v1.cbor, wayfuse.v1.json");
    EXPECT_EQ(header_of(head, "Authorization"), "Bearer secret");
    EXPECT_EQ(header_of(head, "Host"), "127.0.0.1:" + std::to_string(server.port()));
    EXPECT_EQ(header_of(head, "Sec-WebSocket-Extensions"), "");  // no permessage-deflate
    EXPECT_TRUE(head.starts_with("GET /v1/session?x=1 HTTP/1.1\r\n"));
    link.reset();
  }
}

TEST_F(WebsocketLink, MasksItsFramesAndMarksTheirKind) {
  std::atomic<bool> masked{false};
  std::atomic<int> opcode{0};
  RawServer server(greeting([&](RawPeer& peer) {
    if (const auto frame = peer.read_frame()) {
      masked = frame->masked;
      opcode = frame->opcode;
    }
    peer.wait_for_end();
  }));
  open(server);
  ASSERT_TRUE(until_open());
  ASSERT_TRUE(link->send("x"));
  ASSERT_TRUE(run_until([&] { return opcode != 0; }));
  EXPECT_TRUE(masked);
  EXPECT_EQ(opcode, kBinary);
}

TEST_F(WebsocketLink, TellsWhatTheServerAnsweredInsteadOfAnUpgrade) {
  RawServer server([](RawPeer& peer) {
    peer.read_head();
    peer.send_bytes("HTTP/1.1 401 Unauthorized\r\nContent-Length: 0\r\n\r\n");
  });
  open(server);
  ASSERT_TRUE(until_closed());
  EXPECT_EQ(reason(), "the server answered 401 Unauthorized");
}

TEST_F(WebsocketLink, RefusesAServerWithoutACommonSubprotocol) {
  for (const char* chosen : {"", "wayfuse.v9.cbor", "graphql-ws"}) {
    RawServer server(greeting([](RawPeer& peer) { peer.wait_for_end(); }, chosen));
    closed.clear();
    open(server);
    ASSERT_TRUE(until_closed());
    EXPECT_TRUE(opened.empty());
  }
  settings.offer_json = false;  // and one that chose what was not offered
  RawServer server(greeting([](RawPeer& peer) { peer.wait_for_end(); }, "wayfuse.v1.json"));
  closed.clear();
  open(server);
  ASSERT_TRUE(until_closed());
  EXPECT_TRUE(opened.empty());
}

TEST_F(WebsocketLink, GivesUpAServerThatAcceptsAndSaysNothing) {
  // Beast's timeouts fire only while a read is pending; the handshake has a deadline of its own.
  RawServer server([](RawPeer& peer) { peer.wait_for_end(); });
  settings.handshake_most = 60ms;
  open(server);
  ASSERT_TRUE(until_closed());
  EXPECT_EQ(reason(), "no connection within the time allowed");
}

TEST_F(WebsocketLink, GivesUpAServerThatDripsItsAnswer) {
  RawServer server([](RawPeer& peer) {
    peer.read_head();
    peer.send_bytes("HTTP/1.1 101 Switching Protocols\r\n");
    while (peer.send_bytes("X-Filler: 1\r\n")) {
    }
  });
  settings.handshake_most = 5s;
  open(server);
  ASSERT_TRUE(until_closed());  // by the header limit or the deadline
  EXPECT_TRUE(opened.empty());
}

TEST_F(WebsocketLink, NobodyListening) {
  std::uint16_t port = 0;
  {
    RawServer gone([](RawPeer&) {});
    port = gone.port();
  }
  settings.url = "ws://127.0.0.1:" + std::to_string(port) + "/";
  auto factory = loop.links(settings);
  ASSERT_TRUE(factory);
  link = (*factory)();
  link->open({{}, {}, [this](std::string_view reason) { closed.emplace_back(reason); }, {}});
  ASSERT_TRUE(until_closed());
  EXPECT_EQ(reason().find("connect: "), 0u) << reason();
}

TEST_F(WebsocketLink, TakesAMessageOf64KiBAndNotAByteMore) {
  for (const std::size_t over : {0u, 1u}) {
    RawServer server(greeting([&](RawPeer& peer) {
      peer.send_frame(kBinary, std::string(Limits::kMessageBytes + over, 'x'));
      peer.wait_for_end();
    }));
    received.clear();
    closed.clear();
    open(server);
    ASSERT_TRUE(run_until([&] { return !received.empty() || !closed.empty(); }));
    EXPECT_EQ(received.size(), over == 0 ? 1u : 0u) << reason();
    link.reset();
  }
}

TEST_F(WebsocketLink, FragmentsCountTogetherAgainstTheLimit) {
  RawServer server(greeting([](RawPeer& peer) {
    peer.send_frame(kBinary, std::string(40'000, 'x'), false);
    peer.send_frame(0, std::string(40'000, 'x'), true);
    peer.wait_for_end();
  }));
  open(server);
  ASSERT_TRUE(until_closed());
  EXPECT_TRUE(received.empty());
}

TEST_F(WebsocketLink, PutsFragmentsTogetherWithPingsBetween) {
  std::atomic<bool> ponged{false};
  RawServer server(greeting([&](RawPeer& peer) {
    peer.send_frame(kBinary, "a", false);
    peer.send_frame(kPing, "p");
    peer.send_frame(0, "b", false);
    peer.send_frame(0, "c", true);
    const auto pong = peer.read_frame();
    ponged = pong && pong->opcode == kPong && pong->payload == "p";
    peer.wait_for_end();
  }));
  open(server);
  ASSERT_TRUE(run_until([&] { return !received.empty() && ponged; }));
  EXPECT_EQ(received.front(), "abc");
  EXPECT_EQ(alive, 1);
}

TEST_F(WebsocketLink, NothingHeardForTooLongIsDead) {
  RawServer server(greeting([](RawPeer& peer) { peer.wait_for_end(); }));
  settings.idle_most = 60ms;
  open(server);
  ASSERT_TRUE(until_closed());
  EXPECT_EQ(reason(), "nothing heard for too long");
}

TEST_F(WebsocketLink, PingsKeepAQuietLinkAlive) {
  std::atomic<bool> enough{false};
  RawServer server(greeting([&](RawPeer& peer) {
    for (int i = 0; i < 20 && peer.send_frame(kPing, ""); ++i) {
      if (!peer.read_frame()) return;  // the pong: in step with the client, no clock here
    }
    enough = true;
    peer.wait_for_end();
  }));
  settings.idle_most = 2s;
  open(server);
  ASSERT_TRUE(run_until([&] { return enough || !closed.empty(); }));
  EXPECT_EQ(alive, 20);
  EXPECT_TRUE(closed.empty()) << reason();
}

TEST_F(WebsocketLink, APeerThatNeverReadsIsBoundedAndGivenUp) {
  // Writes have neither queue limit nor deadline in Beast; both are the link's own.
  RawServer server(greeting([](RawPeer& peer) {
    char byte;
    while (recv(peer.socket(), &byte, 1, MSG_PEEK) > 0 && peer.send_frame(kPing, "")) {  // sends, but reads nothing
    }
  }));
  settings.write_most = 150ms;
  open(server);
  ASSERT_TRUE(until_open());
  std::size_t taken = 0;
  int refused = 0;
  while (closed.empty()) {
    if (link->send(std::string(60'000, 'x'))) {
      taken += 60'000;
    } else {
      ++refused;
    }
    loop.run_for(1ms);
    ASSERT_LT(taken, 64u << 20);
  }
  EXPECT_EQ(reason(), "the network takes no data");
  EXPECT_GT(refused, 0);
}

TEST_F(WebsocketLink, BoundsItsQueueByFramesAndBytes) {
  RawServer server(greeting([](RawPeer& peer) { peer.wait_for_end(); }));
  open(server);
  ASSERT_TRUE(until_open());
  int taken = 0;
  while (link->send("x")) ++taken;  // the loop does not run meanwhile: nothing leaves
  EXPECT_EQ(taken, 64);
  ASSERT_TRUE(run_until([&] { return link->send("x"); }));
  while (link->send(std::string(50'000, 'x'))) ASSERT_LT(++taken, 200);
}

TEST_F(WebsocketLink, TakesNothingBeforeItIsOpenOrAfterClose) {
  RawServer server(greeting([](RawPeer& peer) { peer.wait_for_end(); }));
  open(server);
  EXPECT_FALSE(link->send("x"));
  ASSERT_TRUE(until_open());
  link->close();
  link->close();  // never twice on the wire
  EXPECT_FALSE(link->send("x"));
  EXPECT_TRUE(closed.empty());
}

TEST_F(WebsocketLink, SendsWhatIsQueuedBeforeItSaysFarewell) {
  std::vector<int> opcodes;
  std::atomic<bool> done{false};
  RawServer server(greeting([&](RawPeer& peer) {
    while (const auto frame = peer.read_frame()) {
      opcodes.push_back(frame->opcode);
      if (frame->opcode == kClose) {
        peer.send_frame(kClose, frame->payload);
        break;
      }
    }
    peer.wait_for_end();
    done = true;
  }));
  open(server);
  ASSERT_TRUE(until_open());
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(link->send("x"));
  link->close();
  link.reset();  // the connection outlives its link for the farewell
  ASSERT_TRUE(run_until([&] { return done.load(); }));
  EXPECT_EQ(opcodes, (std::vector{kBinary, kBinary, kBinary, kBinary, kBinary, kClose}));
}

TEST_F(WebsocketLink, AFarewellNobodyAnswersEndsAnyway) {
  std::atomic<bool> ended{false};
  RawServer server(greeting([&](RawPeer& peer) { ended = peer.wait_for_end(); }));
  settings.close_most = 60ms;
  open(server);
  ASSERT_TRUE(until_open());
  link->close();
  EXPECT_TRUE(run_until([&] { return ended.load(); }));
}

TEST_F(WebsocketLink, TellsWhyTheServerClosed) {
  RawServer server(greeting([](RawPeer& peer) {
    peer.send_frame(kClose, std::string("\x03\xf4", 2) + "draining");
    peer.wait_for_end();
  }));
  open(server);
  ASSERT_TRUE(until_closed());
  EXPECT_EQ(reason(), "the server closed: 1012 draining");
}

TEST_F(WebsocketLink, ALinkCutInMidFrameIsClosed) {
  for (const bool rst : {false, true}) {
    RawServer server(greeting([&](RawPeer& peer) {
      peer.send_bytes(std::string("\x82\x7e\x10\x00", 4) + "only a part");
      if (rst) peer.reset();
    }));
    closed.clear();
    open(server);
    ASSERT_TRUE(until_closed());
    EXPECT_TRUE(received.empty());
    EXPECT_EQ(closed.size(), 1u);
  }
}

TEST_F(WebsocketLink, BrokenFramingEndsTheConnection) {
  const std::vector<std::pair<const char*, std::string>> broken = {
      {"masked by the server", std::string("\x82\x81\x01\x02\x03\x04x", 7)},
      {"reserved bit", std::string("\xc2\x01x", 3)},
      {"reserved opcode 3", std::string("\x83\x01x", 3)},
      {"reserved control opcode 11", std::string("\x8b\x00", 2)},
      {"continuation of nothing", std::string("\x80\x01x", 3)},
      {"a new message inside a message", std::string("\x02\x01x\x82\x01x", 6)},
      {"fragmented ping", std::string("\x09\x00", 2)},
      {"ping of 126 bytes", std::string("\x89\x7e\x00\x7e", 4) + std::string(126, 'x')},
      {"length not in its shortest form", std::string("\x82\x7e\x00\x01x", 5)},
      {"length with its top bit set", std::string("\x82\x7f\xff\xff\xff\xff\xff\xff\xff\xff", 10)},
      {"a length of 4 GiB", std::string("\x82\x7f\x00\x00\x00\x01\x00\x00\x00\x00", 10)},
      {"close with one byte", std::string("\x88\x01\x03", 3)},
      {"close code 1005", std::string("\x88\x02\x03\xed", 4)},
      {"close code 999", std::string("\x88\x02\x03\xe7", 4)},
      {"close reason not UTF-8", std::string("\x88\x04\x03\xe8\xff\xff", 6)},
      {"a text frame where binary was agreed", std::string("\x81\x01x", 3)},
      {"text that is not UTF-8", std::string("\x81\x02\xc3\x28", 4)},
  };
  for (const auto& [what, bytes] : broken) {
    SCOPED_TRACE(what);
    RawServer server(greeting([&](RawPeer& peer) {
      peer.send_bytes(bytes);
      peer.wait_for_end();
    }));
    opened.clear();
    received.clear();
    closed.clear();
    open(server);
    EXPECT_TRUE(until_closed());
    EXPECT_TRUE(received.empty());
    EXPECT_EQ(closed.size(), 1u);
    link.reset();
  }
}

TEST_F(WebsocketLink, MayBeClosedAndDestroyedAnywhere) {
  // In every phase and from inside its own events; the sanitizers are the judges.
  RawServer server(greeting([](RawPeer& peer) {
    peer.send_frame(kBinary, "x");
    peer.wait_for_end();
  }));
  for (int turns = 0; turns < 12; ++turns) {
    open(server);
    for (int i = 0; i < turns; ++i) loop.run_for(100us);
    link.reset();
  }
  opened.clear();
  received.clear();
  on_opened = [this] { link->close(); };
  open(server);
  ASSERT_TRUE(until_open());
  loop.run_for(5ms);
  EXPECT_TRUE(received.empty());
  on_opened = nullptr;
  on_received = [this] { link->close(); };
  open(server);
  ASSERT_TRUE(run_until([&] { return !received.empty(); }));
}

TEST_F(WebsocketLink, LoopsMayEndWithConnectionsInEveryPhase) {
  RawServer server(greeting([](RawPeer& peer) { peer.wait_for_end(); }));
  for (int turns = 0; turns < 12; ++turns) {
    NetworkLoop brief;
    settings.url = "ws://127.0.0.1:" + std::to_string(server.port()) + "/";
    auto factory = brief.links(settings);
    ASSERT_TRUE(factory);
    auto held = (*factory)();
    held->open({[](Encoding) {}, [](std::string_view) {}, [](std::string_view) {}, {}});
    for (int i = 0; i < turns; ++i) brief.run_for(100us);
    brief.after(0s, [kept = std::shared_ptr<Link>(std::move(held))] {});
  }
}

}  // namespace
}  // namespace wayfuse
