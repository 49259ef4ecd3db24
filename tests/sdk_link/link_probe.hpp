#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/fixtures/raw_websocket_server.hpp"
#include "wayfuse/proto/codec.hpp"
#include "wayfuse/sdk/websocket_link.hpp"

namespace wayfuse {

/// One link on a loop, and all it told.
class LinkProbe : public testing::Test {
 protected:
  static constexpr int kText = 1;
  static constexpr int kBinary = 2;
  static constexpr int kClose = 8;
  static constexpr int kPing = 9;
  static constexpr int kPong = 10;

  LinkProbe() { settings.handshake_most = std::chrono::seconds(10); }
  ~LinkProbe() override {
    link.reset();
    loop.run_for(std::chrono::milliseconds(20));
  }

  /// A script that greets with CBOR and goes on with `then`.
  static RawServer::Script greeting(std::function<void(RawPeer&)> then,
                                    std::string subprotocol = std::string(kSubprotocolCbor)) {
    return [then = std::move(then), subprotocol = std::move(subprotocol)](RawPeer& peer) {
      const std::string head = peer.read_head();
      if (head.empty()) return;
      peer.accept_upgrade(head, subprotocol);
      then(peer);
    };
  }

  void open(const RawServer& server, const std::string& scheme = "ws", const std::string& host = "127.0.0.1") {
    settings.url = scheme + "://" + host + ":" + std::to_string(server.port()) + "/v1/session?x=1";
    auto factory = loop.links(settings);
    ASSERT_TRUE(factory) << to_string(factory.fault());
    link = (*factory)();
    link->open({[this](Encoding encoding) {
                  opened.push_back(encoding);
                  if (on_opened) on_opened();
                },
                [this](std::string_view frame) {
                  received.emplace_back(frame);
                  if (on_received) on_received();
                },
                [this](std::string_view reason) { closed.emplace_back(reason); }, [this] { ++alive; }});
  }
  /// Runs the loop until `done`; false = it took more than 20 s.
  bool run_until(const std::function<bool()>& done) {
    const PhoneTime end = loop.now() + std::chrono::seconds(20);
    while (!done() && loop.now() < end) loop.run_for(std::chrono::milliseconds(2));
    return done();
  }
  bool until_open() {
    return run_until([this] { return !opened.empty() || !closed.empty(); }) && !opened.empty();
  }
  bool until_closed() {
    return run_until([this] { return !closed.empty(); });
  }
  std::string reason() const { return closed.empty() ? "(not closed)" : closed.front(); }

  NetworkLoop loop;
  WebsocketLinkSettings settings;
  std::unique_ptr<Link> link;
  std::vector<Encoding> opened;
  std::vector<std::string> received;
  std::vector<std::string> closed;
  int alive = 0;
  std::function<void()> on_opened;
  std::function<void()> on_received;
};

}  // namespace wayfuse
