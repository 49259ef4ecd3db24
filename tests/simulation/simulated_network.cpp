#include "tests/simulation/simulated_network.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse {
namespace {

Rights all_rights() {
  return {.key_id = 1, .track = true, .survey = true, .observe = true, .building = {}, .expires_at = {}};
}

}  // namespace

/// One connection: the client's end and the server's, and what is on the way between them.
class SimulatedNetwork::Connection final : public SessionOutput, public std::enable_shared_from_this<Connection> {
 public:
  Connection(SimulatedNetwork& network, std::uint64_t number, Link::Events events, Encoding encoding)
      : network_(network), number_(number), events_(std::move(events)), encoding_(encoding), outbox_(encoding, {}) {}

  void open(SimulatedServer& server) {
    server_up_ = true;
    conversation_ = begin_conversation(server.world(), *this,
                                       [self = weak_from_this()](std::function<void()> task) {
                                         if (const auto alive = self.lock()) {
                                           alive->network_.scheduler_.after(std::chrono::milliseconds(3), [task, self] {
                                             if (!self.expired()) task();
                                           });
                                         }
                                       },
                                       all_rights(), {});
    client_up_ = true;
    events_.opened(encoding_);
  }
  void fail() {
    if (events_.closed) events_.closed("nobody listens");
  }

  // ---- the client's end
  bool client_send(std::string frame) {
    if (!client_up_) return false;
    towards_server_ = std::max(towards_server_, network_.scheduler_.now() + network_.delay());
    network_.scheduler_.after(towards_server_ - network_.scheduler_.now(),
                              [self = shared_from_this(), frame = std::move(frame)] { self->server_receive(frame); });
    return true;
  }
  void client_close() {
    client_up_ = false;
    abandoned_ = true;
    events_ = {};
    // What was sent before still arrives; then the server learns.
    towards_server_ = std::max(towards_server_, network_.scheduler_.now() + network_.delay());
    network_.scheduler_.after(towards_server_ - network_.scheduler_.now(), [self = shared_from_this()] { self->server_end(); });
  }

  // ---- the server's end
  void send(const ServerMessage& message) override {
    if (!server_up_) return;
    network_.witness_.server_said(number_, message);
    if (!outbox_.push(message)) return cut(Duration{0});  // too slow to be kept
    write();
  }
  bool congested() const override { return !outbox_.empty(); }
  void close(const Fault&) override { finish(); }
  void finish() override {
    finishing_ = true;
    write();
  }
  void tick() {
    if (server_up_) conversation_->tick();
  }

  /// The stream is cut: frames on the way are lost, the client learns now, the server after `unnoticed`.
  void cut(Duration unnoticed) {
    if (cut_) return;
    cut_ = true;
    client_end("the connection was reset");
    network_.scheduler_.after(unnoticed, [self = shared_from_this()] { self->server_end(); });
  }
  /// The server's process is gone: its end is no more, and nothing of it may be called.
  void break_now() {
    cut_ = true;
    server_up_ = false;
    conversation_.reset();
    client_end("the connection was reset");
  }
  bool abandoned() const { return abandoned_; }
  bool over() const { return !client_up_ && !server_up_; }

 private:
  void server_receive(const std::string& frame) {
    if (cut_ || !server_up_ || finishing_) return;
    network_.witness_.frame_arrived(network_.scheduler_.now(), frame);
    auto message = decode_client_message(frame, encoding_);
    if (!message) return conversation_->receive(message.fault());
    network_.witness_.server_heard(number_, *message);
    conversation_->receive(*std::move(message));
  }

  void write() {
    if (writing_ || !server_up_) return;
    auto frame = outbox_.pop();
    if (!frame) {
      if (finishing_) cut(Duration{0});
      return;
    }
    writing_ = true;
    const Duration delay = network_.delay();
    towards_client_ = std::max(towards_client_, network_.scheduler_.now() + delay);
    network_.scheduler_.after(towards_client_ - network_.scheduler_.now(),
                              [self = shared_from_this(), text = *std::move(frame)] { self->client_receive(text); });
    // The socket's buffer takes it long before it arrives, unless the way is congested.
    network_.scheduler_.after(delay / 4, [self = shared_from_this()] {
      self->writing_ = false;
      self->write();
    });
  }

  void client_receive(const std::string& frame) {
    if (cut_ || !client_up_) return;
    network_.witness_.frame_arrived(network_.scheduler_.now(), frame);
    const auto received = events_.received;  // the client may drop its end inside
    received(frame);
  }
  void client_end(std::string_view reason) {
    if (!client_up_) return;
    client_up_ = false;
    const auto closed = std::move(events_.closed);
    events_ = {};
    if (closed) closed(reason);
  }
  void server_end() {
    if (!server_up_) return;
    server_up_ = false;
    conversation_->disconnected();
    conversation_.reset();
  }

  SimulatedNetwork& network_;
  const std::uint64_t number_;
  Link::Events events_;
  const Encoding encoding_;
  Outbox outbox_;
  std::shared_ptr<Conversation> conversation_;
  PhoneTime towards_server_;
  PhoneTime towards_client_;
  bool client_up_ = false;
  bool server_up_ = false;
  bool writing_ = false;
  bool finishing_ = false;
  bool cut_ = false;
  bool abandoned_ = false;  ///< by the client, before or after it opened
};

class SimulatedLink final : public Link {
 public:
  explicit SimulatedLink(SimulatedNetwork& network) : network_(network) {}
  ~SimulatedLink() override { close(); }
  void open(Events events) override { connection_ = network_.connect(std::move(events)); }
  bool send(std::string frame) override { return connection_ && connection_->client_send(std::move(frame)); }
  void close() override {
    if (connection_) connection_->client_close();
    connection_.reset();
  }

 private:
  SimulatedNetwork& network_;
  std::shared_ptr<SimulatedNetwork::Connection> connection_;
};

SimulatedNetwork::SimulatedNetwork(VirtualScheduler& scheduler, std::uint64_t seed, FrameWitness& witness)
    : scheduler_(scheduler), random_(seed), witness_(witness) {}
SimulatedNetwork::~SimulatedNetwork() = default;

void SimulatedNetwork::attach(SimulatedServer* server) {
  server_ = server;
}

void SimulatedNetwork::break_all() {
  auto broken = std::move(connections_);
  connections_.clear();
  for (const auto& connection : broken) connection->break_now();
}

std::unique_ptr<Link> SimulatedNetwork::make_link() {
  return std::make_unique<SimulatedLink>(*this);
}

void SimulatedNetwork::tick() {
  std::erase_if(connections_, [](const auto& connection) { return connection->over(); });
  for (const auto& connection : std::vector(connections_)) connection->tick();
}

std::shared_ptr<SimulatedNetwork::Connection> SimulatedNetwork::connect(Link::Events events) {
  const Encoding encoding = random_.below(2) == 0 ? Encoding::kCbor : Encoding::kJson;
  auto connection = std::make_shared<Connection>(*this, ++last_connection_, std::move(events), encoding);
  const bool fails = random_.uniform() < weather.connect_fails;
  const Duration life = from_seconds(-std::log(1.0 - random_.uniform()) * seconds(weather.life_mean));
  const Duration unnoticed = from_seconds(random_.uniform() * seconds(weather.unnoticed_most));
  scheduler_.after(delay(), [this, connection, fails, life, unnoticed] {
    if (connection->abandoned()) return;
    if (fails || !server_) return connection->fail();
    connections_.push_back(connection);
    connection->open(*server_);
    scheduler_.after(life, [weak = std::weak_ptr(connection), unnoticed] {
      if (const auto alive = weak.lock()) alive->cut(unnoticed);
    });
  });
  return connection;
}

Duration SimulatedNetwork::delay() {
  const bool slow = random_.uniform() < weather.slow_frame;
  return from_seconds(random_.uniform() * seconds(slow ? weather.slow_most : weather.delay_most));
}

}  // namespace wayfuse
