#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <mutex>

#include "tests/fixtures/fault_proxy.hpp"
#include "tests/fixtures/model_server.hpp"
#include "tests/fixtures/raw_websocket_server.hpp"
#include "wayfuse/proto/codec.hpp"
#include "wayfuse/sdk/websocket_link.hpp"

// The whole client over real sockets, through a proxy that delays, stalls, chops, resets, goes half-open and connects twice
// [SAFETY R13, C17]. The virtual-clock twin of this test runs many more seeds; this one has the real link in it.
namespace wayfuse {
namespace {

using namespace std::chrono_literals;

/// The model server behind a socket.
class SocketServer {
 public:
  SocketServer() : server_([this](RawPeer& peer) { serve(peer); }) {}
  std::uint16_t port() const { return server_.port(); }
  ModelServer model() {
    const std::lock_guard lock(mutex_);
    return model_;
  }
  void restart() {
    {
      const std::lock_guard lock(mutex_);
      model_.restart();
    }
    server_.hang_up();
  }

 private:
  void serve(RawPeer& peer) {
    const std::string head = peer.read_head();
    if (head.empty()) return;
    peer.accept_upgrade(head, kSubprotocolCbor);
    std::string name;
    while (const auto frame = peer.read_frame()) {
      if (frame->opcode == 8) {
        peer.send_frame(8, frame->payload);
        return;
      }
      if (frame->opcode != 2) continue;
      for (const ServerMessage& answer : hear(frame->payload, name)) {
        if (!peer.send_frame(2, encode(answer, Encoding::kCbor))) return;
      }
    }
  }
  std::vector<ServerMessage> hear(const std::string& frame, std::string& name) {
    const auto message = decode_client_message(frame, Encoding::kCbor);
    EXPECT_TRUE(message);
    if (!message) return {};
    const std::lock_guard lock(mutex_);
    if (const auto* hello = std::get_if<Hello>(&*message)) {
      const Welcome welcome = model_.greet(*hello);
      name = welcome.session;
      return {welcome};
    }
    if (const auto* batch = std::get_if<SampleBatch>(&*message)) return model_.apply(name, *batch);
    if (const auto* probe = std::get_if<ClockProbe>(&*message)) return {ClockAnswer{probe->phone_time, UnixTime{1s}}};
    return {};
  }

  std::mutex mutex_;
  ModelServer model_;
  RawServer server_;  // last: its threads use the rest
};

/// A phone whose second lasts ten milliseconds.
struct HurriedPhone {
  HurriedPhone(NetworkLoop& network, std::uint64_t seed) : loop(network), proxy(server.port(), seed, FaultPlan{}) {
    WebsocketLinkSettings link;
    link.url = "ws://127.0.0.1:" + std::to_string(proxy.port()) + "/v1/session";
    link.handshake_most = 250ms;
    link.write_most = 250ms;
    link.close_most = 50ms;
    ClientSettings settings;
    settings.building = BuildingId{1};
    settings.batch_interval = 10ms;
    settings.back_off_first = 5ms;
    settings.back_off_most = 50ms;
    settings.connect_most = 300ms;
    settings.greeting_most = 250ms;
    settings.silence_most = 500ms;
    settings.ack_most = 250ms;
    ClientEvents events;
    events.samples_lost = [this](std::uint64_t first, std::uint64_t last) { lost.emplace_back(first, last); };
    auto factory = loop.links(link);
    EXPECT_TRUE(factory);
    client = std::make_unique<Client>(settings, std::move(events), *factory, loop, Random(seed));
    client->start();
    walk();
  }
  void walk() {
    if (sent == 200) return;
    EXPECT_TRUE(client->send(named_motion(++sent, loop.now())));
    loop.after(5ms, [this] { walk(); });
    if (sent == 90) server.restart();
    if (sent == 140) client->network_changed();
  }
  bool through() const { return sent == 200 && client->acked_through() == sent; }

  NetworkLoop& loop;
  SocketServer server;
  FaultProxy proxy;
  std::uint64_t sent = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> lost;
  std::unique_ptr<Client> client;
};

std::uint64_t seeds() {
  const char* wanted = std::getenv("WAYFUSE_FAULT_SEEDS");
  return wanted ? std::strtoull(wanted, nullptr, 10) : 24;
}

TEST(FaultProxyTest, NothingIsLostWhateverTheNetworkDoes) {
  int harmed = 0;
  for (std::uint64_t first = 1; first <= seeds(); first += 12) {
    NetworkLoop loop;
    std::vector<std::unique_ptr<HurriedPhone>> phones;
    for (std::uint64_t seed = first; seed < first + 12; ++seed) phones.push_back(std::make_unique<HurriedPhone>(loop, seed));
    const auto all_through = [&] {
      return std::all_of(phones.begin(), phones.end(), [](const auto& p) { return p->through(); });
    };
    const PhoneTime heal_at = loop.now() + 3s;  // by then the harm is done; from here the network is whole
    const PhoneTime give_up_at = loop.now() + 60s;
    while (!all_through() && loop.now() < give_up_at) {
      loop.run_for(10ms);
      if (loop.now() < heal_at) continue;
      for (const auto& phone : phones) phone->proxy.heal();
    }
    for (const auto& phone : phones) {
      SCOPED_TRACE("seed " + std::to_string(first + static_cast<std::uint64_t>(&phone - phones.data())));
      EXPECT_TRUE(phone->through()) << phone->client->acked_through() << " of " << phone->sent;
      EXPECT_TRUE(phone->lost.empty());
      expect_nothing_lost_in_silence(phone->server.model(), phone->sent, phone->client->acked_through(), phone->lost);
      harmed += phone->proxy.harmed();
    }
    phones.clear();
  }
  EXPECT_GT(harmed, static_cast<int>(seeds()) / 2) << "the proxy was too kind to test anything";
}

}  // namespace
}  // namespace wayfuse
