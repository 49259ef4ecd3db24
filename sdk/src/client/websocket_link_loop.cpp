#include "sdk/src/client/websocket_link_loop.hpp"

#include <openssl/sha.h>
#include <openssl/x509.h>
#include <time.h>

#include <boost/asio/post.hpp>

namespace wayfuse {
namespace asio = boost::asio;

NetworkLoop::NetworkLoop() : state_(std::make_shared<State>()) {}

NetworkLoop::~NetworkLoop() {
  // Cancelled timers let go of their tasks, and links kept by those close while the loop still stands.
  state_->timers.clear();
  state_->io.restart();
  state_->io.poll();
}

PhoneTime NetworkLoop::clock_now() {
#ifdef CLOCK_BOOTTIME
  timespec time{};
  if (clock_gettime(CLOCK_BOOTTIME, &time) == 0) {
    return PhoneTime{std::chrono::seconds(time.tv_sec) + std::chrono::duration_cast<Duration>(std::chrono::nanoseconds(time.tv_nsec))};
  }
#endif
  return PhoneTime{std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch())};
}

std::uint64_t NetworkLoop::after(Duration delay, std::function<void()> task) {
  const std::uint64_t number = ++state_->last_timer;
  auto timer = std::make_shared<asio::steady_timer>(state_->io, delay);
  state_->timers.emplace(number, timer);
  timer->async_wait([weak = std::weak_ptr(state_), number, task = std::move(task)](boost::system::error_code error) {
    const auto state = weak.lock();
    if (!state || error || state->timers.erase(number) == 0) return;  // cancelled, perhaps after it had expired
    task();
  });
  return number;
}

void NetworkLoop::cancel(std::uint64_t timer) { state_->timers.erase(timer); }

void NetworkLoop::post(std::function<void()> task) { asio::post(state_->io, std::move(task)); }

void NetworkLoop::run() {
  const auto work = asio::make_work_guard(state_->io);
  state_->io.restart();
  state_->io.run();
}

void NetworkLoop::run_for(Duration span) {
  const auto work = asio::make_work_guard(state_->io);
  state_->io.restart();
  state_->io.run_for(span);
}

void NetworkLoop::stop() { state_->io.stop(); }

Result<Client::LinkFactory> NetworkLoop::links(WebsocketLinkSettings settings) {
  auto url = parse_websocket_url(settings.url);
  if (!url) return url.fault();
  if (!settings.offer_cbor && !settings.offer_json) {
    return Fault{FaultCode::kOutOfRange, "offer_json", "one encoding at least must be offered"};
  }
  std::shared_ptr<asio::ssl::context> tls;
  if (url->tls) {
    auto made = make_tls_context(settings);
    if (!made) return made.fault();
    tls = *made;
  }
  auto target = std::make_shared<const WebsocketTarget>(
      WebsocketTarget{std::move(settings), std::move(url).value(), state_->io, std::move(tls)});
  return Client::LinkFactory([target] { return make_websocket_link(target); });
}

Result<std::shared_ptr<asio::ssl::context>> make_tls_context(const WebsocketLinkSettings& settings) {
  auto context = std::make_shared<asio::ssl::context>(asio::ssl::context::tls_client);
  boost::system::error_code error;
  SSL_CTX_set_min_proto_version(context->native_handle(), TLS1_2_VERSION);
  SSL_CTX_set_cipher_list(context->native_handle(), "ECDHE+AESGCM:ECDHE+CHACHA20");
  context->set_verify_mode(asio::ssl::verify_peer | asio::ssl::verify_fail_if_no_peer_cert);
  if (!settings.ca_pem.empty()) {
    context->add_certificate_authority(asio::buffer(settings.ca_pem), error);
    if (error) return Fault{FaultCode::kOutOfRange, "ca_pem", error.message()};
  }
  if (!settings.ca_file.empty()) {
    context->load_verify_file(settings.ca_file, error);
    if (error) return Fault{FaultCode::kNotFound, "ca_file", settings.ca_file + ": " + error.message()};
  }
  if (settings.ca_pem.empty() && settings.ca_file.empty()) context->set_default_verify_paths(error);
  return context;
}

std::string public_key_pin(X509* certificate) {
  unsigned char* encoded = nullptr;
  const int length = i2d_X509_PUBKEY(X509_get_X509_PUBKEY(certificate), &encoded);
  if (length <= 0) return {};
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(encoded, static_cast<std::size_t>(length), digest);
  OPENSSL_free(encoded);
  unsigned char text[64];
  const int size = EVP_EncodeBlock(text, digest, sizeof digest);
  return std::string(reinterpret_cast<const char*>(text), static_cast<std::size_t>(size));
}

}  // namespace wayfuse
