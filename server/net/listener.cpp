#include "server/net/listener.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <boost/asio/basic_socket_acceptor.hpp>
#include <boost/asio/bind_executor.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <mutex>
#include <thread>
#include <vector>

#include "server/net/http_connection.hpp"
#include "server/net/tls.hpp"

namespace wayfuse {
namespace {

using asio::ip::tcp;
using boost::system::error_code;
using Acceptor = asio::basic_socket_acceptor<tcp, Strand>;

constexpr int kBacklog = 4096;
constexpr auto kAcceptBackOff = std::chrono::milliseconds(100);

// The address rates are kept by: an IPv6 host has a /64 to play with.
std::string account_of(const asio::ip::address& address) {
  if (!address.is_v6()) return address.to_string();
  auto bytes = address.to_v6().to_bytes();
  if (address.to_v6().is_v4_mapped()) return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).to_string();
  std::fill(bytes.begin() + 8, bytes.end(), static_cast<unsigned char>(0));
  return asio::ip::make_address_v6(bytes).to_string();
}

Fault cannot_listen(const NetSettings& settings, const error_code& error) {
  return {FaultCode::kConflict, "listen", settings.address + ":" + std::to_string(settings.port) + ": " + error.message()};
}

}  // namespace

struct Listener::State {
  explicit State(NetWorld& net) : world(net), acceptor(asio::make_strand(io)), accept_again(io) {}
  ~State() {
    if (reserve >= 0) ::close(reserve);
  }

  Result<void> bind() {
    const NetSettings& settings = world.settings;
    error_code error;
    const auto address = asio::ip::make_address(settings.address, error);
    if (error) return Fault{FaultCode::kOutOfRange, "listen.address", settings.address + " is not an IP address"};
    if (settings.tls_certificate.empty() && !address.is_loopback() && !settings.plain_beyond_loopback) {
      return Fault{
          FaultCode::kNotAllowed, "listen.address",
          settings.address + " is not loopback: configure tls.certificate and tls.key, or allow plain HTTP explicitly"};
    }
    const tcp::endpoint endpoint(address, settings.port);
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(kBacklog, error);
    if (error) return cannot_listen(settings, error);
    bound = acceptor.local_endpoint();
    reserve = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    return {};
  }

  Result<void> load_tls() {
    if (world.settings.tls_certificate.empty()) return {};
    auto fresh = tls_context(world.settings.tls_certificate, world.settings.tls_key);
    if (!fresh) return fresh.fault();
    const std::lock_guard lock(mutex);
    tls = *std::move(fresh);
    return {};
  }

  void accept() {
    acceptor.async_accept(asio::make_strand(io), [this](error_code error, PlainStream socket) {
      if (error) return accept_failed(error);
      receive(std::move(socket));
      accept();
    });
  }

  void accept_failed(const error_code& error) {
    if (!acceptor.is_open()) return;
    world.counters.accept_failures++;
    if (error == boost::system::errc::too_many_files_open || error == boost::system::errc::too_many_files_open_in_system)
      turn_one_away();
    // A broken accept must not spin; a peer that left before it was accepted costs nothing.
    if (error == boost::system::errc::connection_aborted) return accept();
    accept_again.expires_after(kAcceptBackOff);
    accept_again.async_wait(asio::bind_executor(acceptor.get_executor(), [this](error_code stopped) {
      if (!stopped && acceptor.is_open()) accept();
    }));
  }

  // Out of descriptors: the reserved one lets us accept and close, so that the peer is told and the queue moves.
  void turn_one_away() {
    if (reserve < 0) return;
    ::close(reserve);
    const int visitor = ::accept(acceptor.native_handle(), nullptr, nullptr);
    if (visitor >= 0) ::close(visitor);
    reserve = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  }

  void receive(PlainStream socket) {
    error_code error;
    const auto peer = socket.remote_endpoint(error);
    if (error) return;
    NetCounters& counters = world.counters;
    Visit visit{account_of(peer.address()), nullptr, nullptr};
    auto lease = world.addresses->enter(visit.address, world.clock.now());
    if (!lease || counters.connections >= world.settings.connections_most ||
        counters.half_open >= world.settings.half_open_most) {
      counters.refused++;
      return;
    }
    counters.accepted++;
    counters.connections++;
    visit.lease = {lease.get(), [&counters, lease](void*) { counters.connections--; }};
    {
      const std::lock_guard lock(mutex);
      visit.tls = tls;
    }
    socket.set_option(tcp::no_delay(true), error);
    serve_http(world, std::move(socket), std::move(visit));
  }

  struct Beat {
    asio::steady_timer timer;
    Duration interval;
    std::function<void()> task;
  };
  void beat(const std::shared_ptr<Beat>& due) {
    due->timer.expires_after(due->interval);
    due->timer.async_wait([this, due](error_code stopped) {
      if (stopped) return;
      due->task();
      beat(due);
    });
  }

  void run() {
    for (;;) {
      try {
        io.run();
        return;
      } catch (const std::exception& broken) {  // one connection's accident is not everybody's
        world.complain(std::string("a connection failed: ") + broken.what());
      }
    }
  }

  NetWorld& world;
  asio::io_context io;
  asio::executor_work_guard<asio::io_context::executor_type> work = asio::make_work_guard(io);
  Acceptor acceptor;
  asio::steady_timer accept_again;
  tcp::endpoint bound;
  int reserve = -1;
  std::mutex mutex;
  std::shared_ptr<asio::ssl::context> tls;
  std::vector<std::thread> threads;
};

Listener::Listener(std::unique_ptr<State> state) : state_(std::move(state)) {}
Listener::~Listener() {
  stop();
}

Result<std::unique_ptr<Listener>> Listener::open(NetWorld& world) {
  auto state = std::make_unique<State>(world);
  if (const auto loaded = state->load_tls(); !loaded) return loaded.fault();
  if (const auto bound = state->bind(); !bound) return bound.fault();
  return std::unique_ptr<Listener>(new Listener(std::move(state)));
}

std::uint16_t Listener::port() const {
  return state_->bound.port();
}

void Listener::start(unsigned threads) {
  asio::post(state_->acceptor.get_executor(), [state = state_.get()] { state->accept(); });
  every(DeadlineWheel::kSlot, [state = state_.get()] { state->world.wheel.turn(); });
  for (unsigned i = 0; i < threads; ++i) state_->threads.emplace_back([state = state_.get()] { state->run(); });
}

void Listener::every(Duration interval, std::function<void()> task) {
  state_->beat(std::make_shared<State::Beat>(asio::steady_timer(state_->io), interval, std::move(task)));
}

Result<void> Listener::reload_tls() {
  return state_->load_tls();
}

void Listener::drain(Duration within, Duration at_most) {
  NetWorld& world = state_->world;
  const ServerTime give_up = world.clock.now() + at_most;
  world.draining = true;
  asio::post(state_->acceptor.get_executor(), [state = state_.get()] {
    error_code ignored;
    state->acceptor.close(ignored);
  });
  const auto connections = world.wheel.all();
  for (std::size_t i = 0; i < connections.size(); ++i) {
    connections[i]->drain(within, within * static_cast<std::int64_t>(i + 1) / static_cast<std::int64_t>(connections.size()));
  }
  const auto wait = std::chrono::milliseconds(20);
  while (world.counters.connections > 0 && world.clock.now() < give_up) std::this_thread::sleep_for(wait);
  for (const auto& left : world.wheel.all()) left->cut();
  const ServerTime closed = world.clock.now() + std::chrono::milliseconds(500);
  while (world.counters.connections > 0 && world.clock.now() < closed) std::this_thread::sleep_for(wait);
}

void Listener::stop() {
  state_->io.stop();
  for (std::thread& thread : state_->threads) thread.join();
  state_->threads.clear();
}

}  // namespace wayfuse
