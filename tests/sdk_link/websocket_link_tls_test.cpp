#include <fstream>

#include "tests/sdk_link/link_probe.hpp"

namespace wayfuse {
namespace {

using namespace std::chrono_literals;

class WebsocketLinkTls : public LinkProbe {
 protected:
  static RawServer::Script echo() {
    return greeting([](RawPeer& peer) {
      if (const auto frame = peer.read_frame()) peer.send_frame(frame->opcode, frame->payload);
      peer.wait_for_end();
    });
  }
  void expect_refused(const RawServer& server, const std::string& part, const std::string& host = "127.0.0.1") {
    closed.clear();
    open(server, "wss", host);
    ASSERT_TRUE(until_closed());
    EXPECT_TRUE(opened.empty());
    EXPECT_EQ(reason().find("TLS: "), 0u) << reason();
    EXPECT_NE(reason().find(part), std::string::npos) << reason();
  }
};

const TestCertificate& good() {
  static const TestCertificate made = make_test_certificate("DNS:localhost,IP:127.0.0.1");
  return made;
}

TEST_F(WebsocketLinkTls, SpeaksToAServerItWasToldToTrust) {
  RawServer server(echo(), &good());
  settings.ca_pem = good().certificate_pem;
  for (const char* host : {"127.0.0.1", "localhost"}) {
    opened.clear();
    received.clear();
    open(server, "wss", host);
    ASSERT_TRUE(until_open()) << reason();
    ASSERT_TRUE(link->send("hello"));
    ASSERT_TRUE(run_until([&] { return !received.empty(); }));
    EXPECT_EQ(received.front(), "hello");
    link.reset();
  }
}

TEST_F(WebsocketLinkTls, RefusesAnUnknownCertificateByDefault) {
  RawServer server(echo(), &good());
  expect_refused(server, "self-signed");
}

TEST_F(WebsocketLinkTls, RefusesAnotherHostsCertificate) {
  const TestCertificate other = make_test_certificate("DNS:elsewhere.example");
  RawServer server(echo(), &other);
  settings.ca_pem = other.certificate_pem;
  expect_refused(server, "not for 127.0.0.1");
  expect_refused(server, "not for localhost", "localhost");
}

TEST_F(WebsocketLinkTls, RefusesAnExpiredCertificate) {
  const TestCertificate old = make_test_certificate("IP:127.0.0.1", -7200, -3600);
  RawServer server(echo(), &old);
  settings.ca_pem = old.certificate_pem;
  expect_refused(server, "expired");
}

TEST_F(WebsocketLinkTls, RefusesOldTls) {
  RawServer server(echo(), &good(), TLS1_1_VERSION);
  settings.ca_pem = good().certificate_pem;
  expect_refused(server, "");
}

TEST_F(WebsocketLinkTls, APinMustMatchAsWell) {
  RawServer server(echo(), &good());
  settings.ca_pem = good().certificate_pem;
  settings.pins = {"AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA="};
  expect_refused(server, good().pin);
  settings.pins.push_back(good().pin);
  closed.clear();
  open(server, "wss");
  EXPECT_TRUE(until_open()) << reason();
  link.reset();
  settings.ca_pem.clear();  // and is no replacement for trust
  opened.clear();
  expect_refused(server, "self-signed");
}

TEST_F(WebsocketLinkTls, AStreamCutWithoutCloseNotifyIsJustClosed) {
  RawServer server(greeting([](RawPeer& peer) { peer.send_bytes("\x82"); }), &good());
  settings.ca_pem = good().certificate_pem;
  open(server, "wss");
  ASSERT_TRUE(until_closed());
  EXPECT_EQ(closed.size(), 1u);
}

TEST_F(WebsocketLinkTls, APlainServerOnATlsAddressIsRefused) {
  RawServer server([](RawPeer& peer) {
    peer.send_bytes("HTTP/1.1 400 Bad Request\r\n\r\n");
    peer.wait_for_end();
  });
  expect_refused(server, "");
}

TEST_F(WebsocketLinkTls, ATlsServerThatNeverAnswersIsGivenUp) {
  RawServer server([](RawPeer& peer) { peer.wait_for_end(); });
  settings.handshake_most = 60ms;
  open(server, "wss");
  ASSERT_TRUE(until_closed());
  EXPECT_EQ(reason(), "no connection within the time allowed");
}

TEST_F(WebsocketLinkTls, PlainIsForLoopbackUnlessAskedFor) {
  RawServer server(echo());
  open(server, "ws", "0.0.0.0");  // reaches this machine, but is no loopback address
  ASSERT_TRUE(until_closed());
  EXPECT_NE(reason().find("refused: use wss://"), std::string::npos) << reason();
  EXPECT_EQ(server.accepted(), 0);
  settings.allow_plain = true;
  closed.clear();
  open(server, "ws", "0.0.0.0");
  EXPECT_TRUE(until_open()) << reason();
}

TEST_F(WebsocketLinkTls, BadTrustIsNamedAtOnce) {
  settings.url = "wss://127.0.0.1/";
  settings.ca_file = "/nonexistent.pem";
  EXPECT_EQ(loop.links(settings).fault().field, "ca_file");
  settings.ca_file.clear();
  settings.ca_pem = "not a certificate";
  EXPECT_EQ(loop.links(settings).fault().field, "ca_pem");
}

}  // namespace
}  // namespace wayfuse
